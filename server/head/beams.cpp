#include "head/beams.h"

#include <algorithm>
#include <cmath>

#include "beam/response.h"
#include "head/beam_hull.h"
#include "head/head.h"
#include "head/points.h"
#include "head/polyline.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kBlocksPerPiece = 4;
// Under which grooms rest, head frame [m/s^2].
const Vector3d kRestGravity(0, -9.81, 0);
// Of the response of a beam's tip, that of a hanging chain's.
constexpr double kChain = 1.45 / 2.1;
// Of a guide's axis.
constexpr int kAxisChords = 4;
// Over the guide's length: rings have none.
constexpr double kShortestAxis = 0.1;
constexpr int kFewestByDefault = 16, kMostByDefault = 64;
// Of what beams follow: so many that the coils of the curliest hair are round.
constexpr int kPointsPerSegment = 8, kFewestEdges = 256;

// Gives every guide its places, directions and the length of its segments.
void FollowRest(const groom::Groom& groom, std::span<const rod::Row<float>> guides,
                exec::WorkerPool& pool, Beams* beams) {
  const auto k = static_cast<size_t>(beams->segments);
  beams->segment_length.resize(groom.guide_count());
  beams->places.resize(groom.guide_count() * k);
  beams->directions.resize(groom.guide_count() * k);
  const auto blocks = groom.batch.blocks();
  pool.ParallelFor(static_cast<int>(blocks.size()), kBlocksPerPiece, [&](int first, int last) {
    thread_local PointScratch scratch;
    for (int i = first; i < last; ++i) {
      ForRodPoints(groom, blocks[i], guides, {}, CurvePoints(beams->segments), scratch,
                   [&](int guide, std::span<const Vector3f> curve) {
                     const double L = groom.guides[guide].strand.TotalLength();
                     const auto places = std::span(beams->places).subspan(guide * k, k);
                     beams->segment_length[guide] = Stride(curve, L, places);
                     Between(curve, places, std::span(beams->directions).subspan(guide * k, k));
                   });
    }
  });
}

beam::MotionSettings SettingsOf(const BeamOptions& options, std::optional<beam::Hull> hull) {
  beam::MotionSettings settings;
  settings.equations = options.equations;
  settings.bounded = options.bounded;
  settings.clamped = options.clamped;
  settings.avoid_hull = options.avoid_head && hull.has_value();
  settings.hull = std::move(hull);
  settings.alpha = options.alpha;
  settings.near = options.near;
  settings.epsilon = options.epsilon;
  settings.largest_turn = options.largest_turn;
  settings.fluctuation = options.fluctuation;
  settings.seed = options.seed;
  return settings;
}

// The line that a guide winds about: some long chords, which leave out its waves, but not that it
// lies over a head and then falls.
struct Axis {
  double length = 0;                 // [m]
  std::vector<Vector3d> directions;  // Unit, of each segment.
};

Axis AxisOf(std::span<const Vector3d> rest, double segment_length) {
  const int k = static_cast<int>(rest.size());
  Axis axis;
  for (int chord = 0; chord < kAxisChords; ++chord) {
    const int begin = chord * k / kAxisChords, end = (chord + 1) * k / kAxisChords;
    if (begin == end) continue;
    Vector3d way = Vector3d::Zero();
    for (int i = begin; i < end; ++i) way += rest[i];
    axis.length += segment_length * way.norm();
    axis.directions.resize(end, way.normalized());
  }
  axis.length = std::max(axis.length, kShortestAxis * segment_length * k);
  return axis;
}

// What a guide's segments answer to, root first.
struct Answer {
  std::vector<double> response, hold;
  double friction;
};

// Elastic hair that hangs is held by its weight, too. Where it is in equilibrium at rest, bending
// balances what of gravity is across a segment; what is along it, G, turns it back as a pendulum's
// weight does, so that what holds it is K + G (B11 with K for the sum). Lambda is that of a beam,
// 2.1 / L, where K prevails, and that of a hanging chain, 1.45 / L, where G does. Segments that
// stand against gravity are held by K alone.
Answer AnswerOf(const BeamOptions& options, double rigidity, double density, double friction,
                const Axis& axis) {
  const int k = static_cast<int>(axis.directions.size());
  Answer answer{beam::ResponseOf(axis.length, k), beam::HoldOf(rigidity, density, axis.length, k),
                0};
  double bending = 0, weight = 0;
  for (int i = 0; i < k; ++i) {
    const double K = options.hold * answer.hold[i];
    const double G = options.hold > 0 ? std::max(0.0, kRestGravity.dot(axis.directions[i])) : 0;
    answer.hold[i] = K + G;
    bending = K, weight = (weight * i + G) / (i + 1);
  }
  if (options.hold > 0) {
    const double sum = bending + weight;
    for (double& each : answer.response) each *= (bending + kChain * weight) / sum;
    // Friction is in what bends, though it is counted of all that holds (B12).
    answer.friction = friction * bending / sum;
  }
  if (options.tip_response) {
    for (int i = 0; i < k; ++i) answer.response[i] = *options.tip_response * (i + 1) / k;
  }
  return answer;
}

beam::MotionBatch<float> MakeBatch(const groom::Groom& groom, const Beams& beams,
                                   std::optional<beam::Hull> hull) {
  const BeamOptions& options = beams.options;
  std::vector<Answer> answers;
  answers.reserve(groom.guide_count());
  std::vector<beam::MotionHair> hairs;
  for (int i = 0; i < groom.guide_count(); ++i) {
    const groom::Guide& guide = groom.guides[i];
    const rod::Strand& strand = guide.strand;
    const double d = beams.segment_length[i];
    // Hair that winds is a beam along its axis, as much heavier and softer a length as it is
    // longer.
    const Axis axis = AxisOf(beams.rest_of(i), d);
    const double winds = strand.TotalLength() / axis.length;
    const double EI = std::sqrt(strand.stiffness[1] * strand.stiffness[2]);
    const Answer& answer = answers.emplace_back(AnswerOf(
        options, EI / winds, strand.linear_density * winds, strand.internal_friction / EI, axis));
    hairs.push_back({guide.root.p, d, beams.rest_of(i), answer.response, answer.hold,
                     strand.air_drag / strand.linear_density, answer.friction});
  }
  // Nothing balances the weight of what nothing holds.
  const Vector3d gravity = options.hold > 0 ? kRestGravity : Vector3d::Zero();
  return {beams.segments, hairs, gravity, SettingsOf(options, std::move(hull))};
}

// Makes the batch and its state at rest.
void SetBatch(const groom::Groom& groom, std::optional<beam::Hull> hull, Beams* beams) {
  beams->batch = MakeBatch(groom, *beams, std::move(hull));
  beams->rest.resize(beams->batch.state_rows());
  for (int i = 0; i < groom.guide_count(); ++i) {
    beams->batch.SetHair(i, beams->rest_of(i), {}, kLongestStep, beams->rest);
  }
}

// Turns the rest directions of guides out of the hull, those that have nodes there. Returns whether
// there are any.
bool TurnOut(const groom::Groom& groom, const beam::Hull& hull, Beams* beams,
             exec::WorkerPool& pool) {
  const std::vector<int> inside = GuidesInside(groom, *beams, hull);
  if (inside.empty()) return false;
  std::vector<Vector3d> turned = beams->directions;
  KeepOut(*beams, {}, &turned, pool);
  const int k = beams->segments;
  for (const int guide : inside) {
    std::copy_n(turned.begin() + std::ptrdiff_t{guide} * k, k,
                beams->directions.begin() + std::ptrdiff_t{guide} * k);
  }
  return true;
}

}  // namespace

int SegmentsOf(const groom::Groom& groom, const BeamOptions& options) {
  if (options.segments > 0) return options.segments;
  return static_cast<int>(
      std::ceil(std::clamp<double>(groom.turning, kFewestByDefault, kMostByDefault)));
}

int CurvePoints(int segments) { return std::max(kPointsPerSegment * segments, kFewestEdges) + 1; }

std::shared_ptr<const Beams> MakeBeams(const groom::Groom& groom, const Bodies* bodies,
                                       const BeamOptions& options, exec::WorkerPool& pool) {
  auto beams = std::make_shared<Beams>();
  beams->options = options;
  beams->segments = SegmentsOf(groom, options);
  HeadState still = AtRest(groom, {});
  if (bodies != nullptr && !bodies->settled.empty()) still.guides = bodies->settled;
  beams->coordinates = Coordinates(groom, still);
  FollowRest(groom, still.guides, pool, beams.get());
  const auto hull = HullOf(groom, *beams);
  SetBatch(groom, hull, beams.get());
  if (hull && options.avoid_head && TurnOut(groom, *hull, beams.get(), pool)) {
    SetBatch(groom, hull, beams.get());
  }

  beams->roots.resize(beams->batch.blocks());
  for (int i = 0; i < groom.guide_count(); ++i) {
    const Vector3f root = groom.guides[i].root.p.cast<float>();
    const int first = i % simd::kLanes;
    const int last = i + 1 == groom.guide_count() ? simd::kLanes : first + 1;
    for (int axis = 0; axis < 3; ++axis) {
      std::fill(beams->roots[i / simd::kLanes][axis].lane + first,
                beams->roots[i / simd::kLanes][axis].lane + last, root[axis]);
    }
  }
  return beams;
}

}  // namespace mane::head
