#pragma once

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "beam/motion.h"
#include "beam/packing.h"
#include "beam/response.h"
#include "beam/test_every_isa.h"
#include "beam/test_random.h"
#include "simd/isa.h"

/// Moving hairs for tests.
namespace mane::beam::fixtures {

using Eigen::Matrix3d;
using Eigen::Vector3d;

inline const KernelTable<double>& Kernels() { return KernelsFor<double>(simd::Best()); }

/// A hair that owns what a MotionHair shows.
struct OwnHair {
  Vector3d root = Vector3d::Zero();
  double segment_length = 0.01;
  std::vector<Vector3d> rest;
  std::vector<double> response, hold;
  double drag = 0, friction = 0;

  [[nodiscard]] MotionHair Show() const {
    return {root, segment_length, rest, response, hold, drag, friction};
  }
  [[nodiscard]] int segments() const { return static_cast<int>(rest.size()); }
};

/// A straight hair along `direction` that nothing holds, of one lambda.
inline OwnHair Free(int segments, const Vector3d& direction, double lambda) {
  OwnHair hair;
  hair.rest.assign(segments, direction.normalized());
  hair.response.assign(segments, lambda);
  hair.hold.assign(segments, 0.0);
  return hair;
}

/// A head that does not move, under this field.
inline MotionDrive Still(const Vector3d& field, double dt) {
  MotionDrive drive;
  drive.velocity_before = drive.velocity = drive.spin_before = drive.spin = Vector3d::Zero();
  drive.gravity = field;
  drive.duration = dt;
  return drive;
}

/// A batch with its state, begun at rest.
template <typename T>
class Moving {
 public:
  Moving(std::vector<OwnHair> hairs, const MotionSettings& settings,
         const Vector3d& gravity = Vector3d::Zero())
      : hairs_(std::move(hairs)) {
    std::vector<MotionHair> shown;
    for (const OwnHair& hair : hairs_) shown.push_back(hair.Show());
    batch_ = MotionBatch<T>(hairs_[0].segments(), shown, gravity, settings);
    state_.resize(batch_.state_rows());
    for (int i = 0; i < count(); ++i) Set(i, hairs_[i].rest, {}, 1);
  }

  void Set(int i, std::span<const Vector3d> directions, std::span<const Vector3d> rates,
           double duration) {
    batch_.SetHair(i, directions, rates, duration, state_);
  }
  void Step(const KernelTable<T>& kernels, const MotionDrive& drive,
            const Vector3d& wind = Vector3d::Zero()) {
    simd::Row<T> rows[3];
    for (int i = 0; i < 3; ++i) {
      std::ranges::fill(rows[i].lane, static_cast<T>(wind[i]));
    }
    for (int block = 0; block < batch_.blocks(); ++block) {
      batch_.Step(kernels, block, drive, rows, state_);
    }
  }
  [[nodiscard]] std::vector<Vector3d> Directions(int i) const {
    std::vector<Vector3d> e(batch_.segments());
    batch_.GetHair(i, 1, state_, e, {});
    return e;
  }
  /// Last steps [rad].
  [[nodiscard]] std::vector<Vector3d> Steps(int i) const {
    std::vector<Vector3d> e(batch_.segments()), steps(batch_.segments());
    batch_.GetHair(i, 1, state_, e, steps);
    return steps;
  }
  /// Nodes as the kernel gives them, from the head's place.
  [[nodiscard]] std::vector<Vector3d> Nodes(const KernelTable<T>& kernels, int i,
                                            const math::Pose& head = {}) const {
    std::vector<simd::Row<T>> rows(3 * (batch_.segments() + 1));
    batch_.Nodes(kernels, i / simd::kLanes, head, state_, rows);
    std::vector<Vector3d> nodes;
    for (size_t row = 0; row < rows.size(); row += 3) {
      nodes.emplace_back(VectorAt(&rows[row], i % simd::kLanes));
    }
    return nodes;
  }
  [[nodiscard]] int count() const { return static_cast<int>(hairs_.size()); }
  [[nodiscard]] const OwnHair& hair(int i) const { return hairs_[i]; }
  [[nodiscard]] const MotionBatch<T>& batch() const { return batch_; }
  [[nodiscard]] std::span<simd::Row<T>> state() { return state_; }

 private:
  std::vector<OwnHair> hairs_;
  MotionBatch<T> batch_;
  std::vector<simd::Row<T>> state_;
};

/// A hair on `hull` that is held in a random shape, with some of everything.
inline OwnHair AnyHair(Random& random, int segments, const Hull& hull) {
  OwnHair hair;
  hair.root = hull.center + hull.radii.cwiseProduct(random.Direction());
  hair.segment_length = random.Uniform(0.002, 0.02);
  hair.rest = random.Directions(segments);
  hair.response = ResponseOf(segments * hair.segment_length, segments);
  for (int i = 0; i < segments; ++i) hair.hold.push_back(random.Uniform(0, 100));
  hair.drag = random.Uniform(0, 3);
  hair.friction = random.Uniform(0, 0.05);
  return hair;
}
inline MotionDrive AnyDrive(Random& random, double dt) {
  MotionDrive drive = Still(random.Vector(10), dt);
  drive.head = {random.Vector(1), math::FromRotationVector(random.Vector(2))};
  drive.velocity_before = random.Vector(1), drive.velocity = random.Vector(1);
  drive.spin_before = random.Vector(5), drive.spin = random.Vector(5);
  drive.duration_before = dt * random.Uniform(0.5, 2);
  drive.drag_scale = random.Uniform(0, 2), drive.friction_scale = random.Uniform(0, 2);
  drive.frame = random.Bits() % 100;
  return drive;
}

/// The angle between unit vectors [rad].
inline double Angle(const Vector3d& a, const Vector3d& b) {
  return 2 * std::atan2((a - b).norm(), (a + b).norm());
}

}  // namespace mane::beam::fixtures
