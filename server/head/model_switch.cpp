#include "head/model_switch.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "head/beam_follow.h"
#include "head/beam_hull.h"
#include "head/polyline.h"
#include "head/shown.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Row = rod::Row<float>;

constexpr int kBlocksPerPiece = 4;
// Between shapes of beams that rods' rates are taken from [s], and
constexpr double kInstant = 1e-3;
// between shapes of rods that beams' are.
constexpr double kMoment = 1.0 / 60;

// What the head shows, from its place in its own axes, (guides x points).
std::vector<Vector3f> ShownInHead(const groom::Groom& groom, const HeadState& state, int points,
                                  exec::WorkerPool& pool) {
  std::vector<Vector3f> all(static_cast<size_t>(groom.guide_count()) * points);
  const Eigen::Matrix3f back = state.pose.q.conjugate().toRotationMatrix().cast<float>();
  pool.ParallelFor(ShownBlocks(groom, state), kBlocksPerPiece, [&](int first, int last) {
    thread_local PointScratch scratch;
    for (int i = first; i < last; ++i) {
      ForShownPoints(groom, state, i, points, scratch,
                     [&](int guide, std::span<const Vector3f> shown) {
                       Vector3f* const own = &all[static_cast<size_t>(guide) * points];
                       for (int j = 0; j < points; ++j) own[j] = back * shown[j];
                     });
    }
  });
  return all;
}

// Rows of a state a moment before, by their rates.
std::vector<Row> Before(const groom::Groom& groom, std::span<const Row> guides) {
  std::vector<Row> before(guides.begin(), guides.end());
  for (const auto& block : groom.batch.blocks()) {
    const int rows = rod::layout::StateRowsPerElement(block.kind);
    const int coordinates = block.kind == rod::layout::Kind::kWound ? 4 : 3;
    for (int Q = 0; Q < block.elements; ++Q) {
      Row* const element = &before[block.state + static_cast<size_t>(Q) * rows];
      for (int i = 0; i < coordinates; ++i) {
        for (int lane = 0; lane < simd::kLanes; ++lane) {
          element[i].lane[lane] -=
              static_cast<float>(kMoment) * element[coordinates + i].lane[lane];
        }
      }
    }
  }
  return before;
}

// Directions of all beams between those points of rods at which their nodes are at rest, head's
// axes: the same of the hair whatever its shape, so that directions of two shapes differ by what
// hair moves.
std::vector<Vector3d> AlongRods(const groom::Groom& groom, const Beams& beams,
                                std::span<const Row> guides, exec::WorkerPool& pool) {
  std::vector<Vector3d> directions(beams.directions.size());
  const auto k = static_cast<size_t>(beams.segments);
  const auto blocks = groom.batch.blocks();
  pool.ParallelFor(static_cast<int>(blocks.size()), kBlocksPerPiece, [&](int first, int last) {
    thread_local PointScratch scratch;
    for (int i = first; i < last; ++i) {
      ForRodPoints(groom, blocks[i], guides, {}, CurvePoints(beams.segments), scratch,
                   [&](int guide, std::span<const Vector3f> curve) {
                     Between(curve, std::span(beams.places).subspan(guide * k, k),
                             std::span(directions).subspan(guide * k, k));
                   });
    }
  });
  return directions;
}

void RodsToBeams(const groom::Groom& groom, std::shared_ptr<const Beams> beams, HeadState* state,
                 exec::WorkerPool& pool) {
  *state = FullDetail(groom, std::move(*state));
  std::vector<Vector3d> now = AlongRods(groom, *beams, state->guides, pool);
  std::vector<Vector3d> rates = AlongRods(groom, *beams, Before(groom, state->guides), pool);
  const Eigen::Matrix3d R = state->pose.q.toRotationMatrix();
  for (size_t i = 0; i < now.size(); ++i) {
    rates[i] = R * ((now[i] - rates[i]) / kMoment) + state->beams.spin.cross(R * now[i]);
    now[i] = R * now[i];
  }
  KeepOut(*beams, state->pose, &now, pool);
  state->beams.active = true;
  state->beams.rows = beams->rest;
  state->beams.beams = std::move(beams);
  const auto k = static_cast<size_t>(state->beams.beams->segments);
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    state->beams.beams->batch.SetHair(guide, std::span(now).subspan(guide * k, k),
                                      std::span(rates).subspan(guide * k, k), state->beams.duration,
                                      state->beams.rows);
  }
}

// Velocity of the beam at a fraction of its length [m/s].
//
// @param rates  of its directions, world [1/s].
Vector3d VelocityAt(const Vector3d& root, double d, std::span<const Vector3d> rates,
                    double fraction) {
  Vector3d velocity = root;
  double left = fraction * static_cast<double>(rates.size());
  for (size_t i = 0; i < rates.size() && left > 0; ++i, left -= 1) {
    velocity += std::min(left, 1.0) * d * rates[i];
  }
  return velocity;
}

// Gives the rod of a guide the shape and the motion of its beam.
void RodToBeam(const groom::Groom& groom, int guide, HeadState* state) {
  const BeamState& from = state->beams;
  const Beams& beams = *from.beams;
  const int k = beams.segments;
  std::vector<Vector3d> directions(k), rates(k), before(k);
  beams.batch.GetHair(guide, from.duration, from.rows, directions, rates);
  const Eigen::Matrix3d back = state->pose.q.conjugate().toRotationMatrix();
  const Vector3d spin = back * from.spin;
  for (int i = 0; i < k; ++i) {
    directions[i] = back * directions[i];
    const Vector3d relative = back * rates[i] - spin.cross(directions[i]);
    before[i] = (directions[i] - kInstant * relative).normalized();
  }
  const groom::Guide& own = groom.guides[guide];
  const int N = own.strand.elements(), width = own.wound ? 4 : 3;
  std::vector<double> now(own.coordinate_count()), then(now.size());
  FollowBeam(groom, beams, guide, directions, now);
  FollowBeam(groom, beams, guide, before, then);

  const Vector3d arm = state->pose.q * own.root.p;
  const Vector3d root = from.velocity + from.spin.cross(arm);
  const double d = beams.segment_length[guide], L = own.strand.TotalLength();
  const std::span<const double> nodes = own.wound ? std::span<const double>(rod::kBeadRule.nodes)
                                                  : std::span<const double>(rod::kGauss.nodes);
  std::vector<Vector3d> velocity;
  double s = 0;
  for (int Q = 0; Q < N; ++Q) {
    for (const double node : nodes) {
      velocity.push_back(VelocityAt(root, d, rates, (s + node * own.strand.length[Q]) / L));
    }
    s += own.strand.length[Q];
  }
  const auto fill = [&](auto& x, auto& rate) {
    for (int Q = 0; Q < N; ++Q) {
      for (int i = 0; i < width; ++i) {
        const double value = now[Q * width + i];
        x[Q][i] = value;
        rate[Q][i] = (value - then[Q * width + i]) / kInstant;
      }
    }
  };
  if (own.wound) {
    std::vector<rod::Vector4d> x(N), rate(N);
    fill(x, rate);
    groom.batch.SetStrand(guide, rod::WoundState{x, rate, velocity}, state->guides);
  } else {
    std::vector<Vector3d> theta(N), rate(N);
    fill(theta, rate);
    groom.batch.SetStrand(guide, rod::StrandState{theta, rate, velocity}, state->guides);
  }
}

void BeamsToRods(const groom::Groom& groom, HeadState* state, exec::WorkerPool& pool) {
  pool.ParallelFor(groom.guide_count(), kBlocksPerPiece * simd::kLanes, [&](int first, int last) {
    for (int guide = first; guide < last; ++guide) RodToBeam(groom, guide, state);
  });
  state->beams.active = false;
  state->beams.beams = nullptr;
  state->beams.rows = {};
  Contact& contact = state->contact;
  if (contact.bodies == nullptr) return;
  for (int i = 0; i < std::ssize(groom.batch.blocks()); ++i) ForgetContact(i, {}, &contact);
  contact.wisps.Clear();
  contact.velocity = state->beams.velocity;
  contact.spin = state->beams.spin;
}

}  // namespace

void StartBeams(std::shared_ptr<const Beams> beams, HeadState* state) {
  state->beams.beams = std::move(beams);
  state->beams.active = true;
  PutBeamsToRest(state->pose, &state->beams);
}

void SwitchModel(const groom::Groom& groom, std::shared_ptr<const Beams> beams, int points,
                 HeadState* state, exec::WorkerPool& pool) {
  if (state->beams.active && beams == state->beams.beams) return;
  if (!state->beams.active && beams == nullptr) return;
  const std::vector<Vector3f> shown = ShownInHead(groom, *state, points, pool);
  if (state->beams.active) BeamsToRods(groom, state, pool);
  if (beams != nullptr) RodsToBeams(groom, std::move(beams), state, pool);

  state->transition = {};
  const std::vector<Vector3f> own = ShownInHead(groom, *state, points, pool);
  Transition transition{points, state->time, {}};
  transition.offsets.reserve(static_cast<size_t>(groom.guide_count()) * (points - 1));
  for (size_t guide = 0; guide < static_cast<size_t>(groom.guide_count()); ++guide) {
    for (size_t j = guide * points; j + 1 < (guide + 1) * points; ++j) {
      transition.offsets.emplace_back((shown[j + 1] - shown[j]) - (own[j + 1] - own[j]));
    }
  }
  state->transition = std::move(transition);
}

}  // namespace mane::head
