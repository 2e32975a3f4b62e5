#include "head/settle.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "head/head.h"
#include "head/kernels.h"
#include "head/points.h"
#include "head/wisps.h"
#include "math/rigid.h"

namespace mane::head {
namespace {

constexpr double kThickTime = 10;  // [s]
constexpr double kDamping = 10;    // Rate at which air stops free hair [1/s]: next to critical.
// Thick air makes what slides slow as well. So then all goes on in its own air until it rests, this
// long at most [s]:
constexpr double kOwnTime = 20;
constexpr double kOwnSteps = 2e7;        // of large grooms for so many steps of an element in all,
constexpr double kWatch = 1;             // until in so long [s]
constexpr float kRestingWay = 5e-6F;     // tips come no farther [m]: what creeps may yet fall,
constexpr int kGuidesToOneMoving = 200;  // but for one in so many, as of many some always slide.

// Hair that lies deeper in a body at rest starts from its natural shape [m].
constexpr double kDeep = 3e-3;

// The natural shape of a guide, as Groom::rest_of.
std::vector<double> NaturalShape(const groom::Guide& guide) {
  std::vector<double> coordinates;
  const int N = guide.strand.elements();
  for (int Q = 0; Q < N; ++Q) {
    const Eigen::Vector3d theta = guide.strand.length[Q] * guide.strand.natural[Q];
    if (guide.wound) {
      const rod::Vector4d& x = guide.wound->natural[Q];
      coordinates.insert(coordinates.end(), x.data(), x.data() + 4);
    } else {
      coordinates.insert(coordinates.end(), theta.data(), theta.data() + 3);
    }
  }
  return coordinates;
}

// The natural shape bent at its root to stand up from the head, half way to the vertical.
std::vector<double> RaisedShape(const groom::Guide& guide) {
  const Eigen::Vector3d aside(guide.root.p.x(), 0, guide.root.p.z());
  const Eigen::Vector3d away = (aside.stableNormalized() + Eigen::Vector3d::UnitY()).normalized();
  Eigen::Matrix3d left = guide.root.q.toRotationMatrix();
  if (guide.wound) left = left * guide.wound->coil[0].F;
  const Eigen::Vector3d bend = math::RotationVector(
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), left.transpose() * away));
  std::vector<double> coordinates = NaturalShape(guide);
  coordinates[1] = bend.y(), coordinates[2] = bend.z();  // As of a wound one's axis.
  return coordinates;
}

// Puts guides that lie deep in a body to the shape that `shape_of` says.
template <typename ShapeOf>
void MoveDeepGuides(const groom::Groom& groom, const ShapeOf& shape_of, HeadState* state) {
  WispStep::Drive drive;
  const rod::ClampMotion still{{}, {}, kLongestStep};
  rod::SetDrive<float>(still, {}, 0, rod::layout::kLanes, drive);
  std::vector<contact::GroupMotion> motions;
  SetGroupMotions(state->contact, {}, still, 0, 1, &motions);
  std::vector<const contact::BodyGroup*> groups;
  for (const Bodies::Group& group : state->contact.bodies->groups) groups.push_back(&group.bodies);
  const contact::BatchContact among{Kernels(), Meetings(), groups, motions, {}};
  contact::BatchContactScratch scratch;
  for (size_t i = 0; i < groom.batch.blocks().size(); ++i) {
    const auto& block = groom.batch.blocks()[i];
    const Contact::Block& own = state->contact.blocks[i];
    contact::BlockStep step(among, groom.batch, block, own.first_point, drive,
                            std::span(state->contact.memory).subspan(own.first, own.rows),
                            state->guides, scratch);
    step.Begin();
    for (int lane = 0; lane < block.count; ++lane) {
      float least = 0;
      for (int point = 0; point < step.points(); ++point) {
        least = std::min(least, step.Distance(point, lane));
      }
      if (least > -kDeep) continue;
      const int guide = block.strands[lane];
      groom.batch.SetStill(guide, shape_of(groom.guides[guide]), state->guides);
    }
  }
}

// Where a rest shape leads through a body, coming out on its nearest side would leave hair through
// neck and nose, or in two bodies that overlap: it falls on them from outside instead, from its
// natural shape, which points away, or from above where that does not.
void LiftDeepGuides(const groom::Groom& groom, HeadState* state) {
  MoveDeepGuides(groom, NaturalShape, state);
  MoveDeepGuides(groom, RaisedShape, state);
}

// Factor on the drag of `groom` that damps so its hair that is damped least.
double DragScale(const groom::Groom& groom) {
  double least = std::numeric_limits<double>::infinity();
  for (const groom::Guide& guide : groom.guides) {
    least = std::min(least, guide.strand.air_drag / guide.strand.linear_density);
  }
  return std::max(1.0, kDamping / std::max(least, 1e-3));
}

// Where the tips of all guides are (guides).
std::vector<Eigen::Vector3f> Tips(const groom::Groom& groom, const HeadState& state) {
  std::vector<Eigen::Vector3f> tips(groom.guide_count());
  PointScratch scratch;
  for (const auto& block : groom.batch.blocks()) {
    ForRodPoints(
        groom, block, state.guides, state.pose, 2, scratch,
        [&](int guide, std::span<const Eigen::Vector3f> points) { tips[guide] = points.back(); });
  }
  return tips;
}

bool Rests(const std::vector<Eigen::Vector3f>& before, const std::vector<Eigen::Vector3f>& now) {
  int moving = 0;
  for (size_t i = 0; i < now.size(); ++i) moving += (now[i] - before[i]).norm() > kRestingWay;
  return moving <= std::ssize(now) / kGuidesToOneMoving;
}

Result<void> Pass(const groom::Groom& groom, const Environment& air, double time, HeadState* state,
                  exec::WorkerPool& pool, const base::Cancelled& cancelled) {
  const int steps = static_cast<int>(time / kLongestStep);
  for (int i = 0; i < steps; ++i) {
    if (base::IsCancelled(cancelled)) return base::CancelledError();
    Advance(groom, {math::Pose{}, kLongestStep, 1}, air, state, pool);
  }
  return {};
}

}  // namespace

Result<void> Settle(const groom::Groom& groom, const std::shared_ptr<Bodies>& bodies,
                    exec::WorkerPool& pool, const base::Cancelled& cancelled) {
  HeadState state = AtRest(groom, {});
  if (bodies->bodies.empty()) {
    bodies->settled = std::move(state.guides);
    return {};
  }
  StartContact(groom, bodies, &state);
  LiftDeepGuides(groom, &state);
  Environment thick;
  thick.air_drag_scale = DragScale(groom);
  if (auto done = Pass(groom, thick, kThickTime, &state, pool, cancelled); !done) return done;
  const double longest =
      std::min(kOwnTime, kOwnSteps / SteppedElements(groom, state) * kLongestStep);
  bool rests = false;
  for (double time = 0; time < longest && !rests; time += kWatch) {
    const std::vector<Eigen::Vector3f> before = Tips(groom, state);
    rests = true;
    // Twice, lest what swings is seen where it was.
    for (const double part : {0.4, 0.6}) {
      if (auto done = Pass(groom, {}, part * kWatch, &state, pool, cancelled); !done) return done;
      rests = rests && Rests(before, Tips(groom, state));
    }
  }
  std::vector<double> coordinates = Coordinates(groom, state);
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    const auto own =
        std::span(coordinates)
            .subspan(groom.first_coordinate[guide], groom.guides[guide].coordinate_count());
    groom.batch.SetStill(guide, own, state.guides);
  }
  bodies->settled = std::move(state.guides);
  bodies->settled_memory = std::move(state.contact.memory);
  return {};
}

}  // namespace mane::head
