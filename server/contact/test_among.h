#pragma once

#include <Eigen/Core>

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "contact/batch_contact.h"
#include "contact/test_meshes.h"
#include "contact/test_step.h"
#include "rod/chain.h"
#include "rod/test_batches.h"

namespace mane::contact::fixtures {

using Eigen::Vector3d;
using rod::Row;
using rod::fixtures::State;
using rod::layout::kLanes;

/// Strands of equal N on a head, stepped among bodies that have a motion of their own.
class Among {
 public:
  Among(simd::Isa isa, BodyShape shape, const Friction& friction)
      : step_(rod::KernelsFor<float>(isa)), meetings_(MeetingKernelsFor(isa)) {
    AddBody(std::move(shape), {}, friction);
  }

  // One more, which moves on its own.
  void AddBody(BodyShape shape, const math::Pose& pose, const Friction& friction) {
    BodyGroup& group = groups_.emplace_back();
    group.bodies.push_back({std::move(shape), {pose, pose}});
    group.frictions.push_back(friction);
  }

  void Add(const rod::Strand& strand, const math::Pose& root, const State& state) {
    strands_.push_back(std::make_unique<rod::Strand>(strand));
    roots_.push_back(root);
    starts_.push_back(state);
  }
  void Pack() {
    std::vector<rod::RootedStrand> rooted;
    for (size_t i = 0; i < strands_.size(); ++i) rooted.push_back({strands_[i].get(), roots_[i]});
    batch_ = rod::Batch<float>(rooted);
    state_.resize(batch_.state_rows());
    for (size_t i = 0; i < strands_.size(); ++i) {
      batch_.SetStrand(static_cast<int>(i), starts_[i].View(), state_);
    }
    ASSERT_EQ(batch_.blocks().size(), 1U);
    first_point_ = FirstPoints(batch_, block());
    for (const BodyGroup& group : groups_) group_list_.push_back(&group);
    motions_.resize(groups_.size());
    memory_.resize(MemoryRows(points(), groups_.size()));
    Forget(memory_);
  }
  [[nodiscard]] uint32_t Step(const rod::ClampMotion& head, const rod::Surroundings& air,
                              const BodyMotion& body) {
    rod::SetDrive<float>(head, air, 0, kLanes, drive_);
    motions_.assign(groups_.size(), MotionOf(body, head));
    const BatchContact contact{step_, meetings_, group_list_, motions_, settings};
    return StepBlockAmong(contact, batch_, block(), first_point_, drive_, memory_, state_, scratch);
  }
  [[nodiscard]] State Get(int i) const {
    State state = starts_[i];
    batch_.GetStrand(i, state_, state.View());
    return state;
  }
  [[nodiscard]] Vector3d Tip(int i) const {
    return rod::fixtures::Tip(*strands_[i], roots_[i], Get(i).theta);
  }
  // How deep the centreline beyond `root` [m] of its length lies in a shape at rest, on a head at
  // `head` [m].
  [[nodiscard]] double Deepest(int i, const BodyShape& shape, double root,
                               const math::Pose& head = {}) const {
    const State state = Get(i);
    double deepest = -1;
    for (double s = root; s < strands_[i]->TotalLength(); s += 1e-3) {
      const Vector3d p =
          rod::PointAt(*strands_[i], head * roots_[i], state.theta, rod::Locate(*strands_[i], s)).r;
      deepest = std::max(deepest, -At(shape, p).distance);
    }
    return deepest;
  }
  // How a point of the first lane met a body in the last solution of a step, in the kernel's units.
  struct Meeting {
    double rub, mass, hold;
    Vector3d velocity, normal, tangent;
    double pressing;    // Normal impulse,
    Vector3d friction;  // and across.
  };
  [[nodiscard]] Meeting MeetingOf(int point) const {
    const auto number = [](const std::vector<Row<float>>& rows, int row) {
      return double{rows[row].lane[0]};
    };
    const auto vector = [&](const std::vector<Row<float>>& rows, int row) {
      return Vector3d(number(rows, row), number(rows, row + 1), number(rows, row + 2));
    };
    const int load = point * rod::layout::kLoadRows, meeting = point * kMeetingRows;
    const double hold = number(scratch.loads, load + rod::layout::kHold);
    const Vector3d u = vector(scratch.velocities, 3 * point),
                   n = vector(scratch.loads, load + rod::layout::kNormal),
                   push = vector(scratch.loads, load + rod::layout::kPush);
    const Vector3d t =
        vector(scratch.points, point * rod::layout::kPointRows + rod::layout::kTangent);
    const double press = number(scratch.loads, load + rod::layout::kPress);
    const Vector3d rubs = push - hold * u;
    return {number(scratch.meetings, meeting + kRub),
            number(scratch.meetings, meeting + kMass),
            hold,
            u,
            n,
            t,
            n.dot(push) - press * n.dot(u),
            rubs - n * n.dot(rubs)};
  }
  [[nodiscard]] const rod::Batch<float>::Block& block() const { return batch_.blocks()[0]; }
  [[nodiscard]] int points() const { return first_point_.back(); }
  [[nodiscard]] const std::vector<Row<float>>& state() const { return state_; }

  BatchContactSettings settings;
  BatchContactScratch scratch;

 private:
  const rod::KernelTable<float>& step_;
  const MeetingKernels& meetings_;
  std::vector<BodyGroup> groups_;
  std::vector<const BodyGroup*> group_list_;
  std::vector<GroupMotion> motions_;
  std::vector<std::unique_ptr<rod::Strand>> strands_;
  std::vector<math::Pose> roots_;
  std::vector<State> starts_;
  rod::Batch<float> batch_;
  std::vector<Row<float>> state_, memory_;
  std::array<Row<float>, rod::layout::kDriveRows> drive_;
  std::vector<int> first_point_;
};

/// A table whose top is y = 0.
inline BodyShape Table() {
  static const std::shared_ptr<const MeshField> field = [] {
    exec::WorkerPool pool(2);
    return *MeshField::Build(Box({-0.15, -0.06, -0.3}, {0.35, 0, 0.3}), {}, &pool);
  }();
  return field;
}

/// Soft straight hair along x on the table, from its root on.
struct Lying {
  rod::Strand strand;
  math::Pose root{{0, 5e-4, 0}, Eigen::Quaterniond::Identity()};

  explicit Lying(int N) : strand(rod::fixtures::HeavyStrand(2e4, N)) {
    strand.air_drag = 2 * strand.linear_density;  // Settles within some seconds.
  }
};

}  // namespace mane::contact::fixtures
