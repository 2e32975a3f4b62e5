#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "beam/motion.h"
#include "beam/response.h"
#include "math/random.h"
#include "simd/isa.h"

/// Moving hairs, and a fixture of every instruction set, that the tests of this folder share.
namespace mane::beam::fixtures {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A typed test of the kernels of a number type.
template <typename T>
class EveryIsaTest : public testing::Test {
 protected:
  /// Calls check(kernels) for every instruction set of this machine.
  template <typename Check>
  void ForEveryIsa(const Check& check) {
    for (const simd::Isa isa : simd::Supported()) {
      SCOPED_TRACE(std::string(simd::Name(isa)));
      check(KernelsFor<T>(isa));
    }
  }
};

/// Both number types.
using Numbers = testing::Types<float, double>;

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
      const int lane = i % simd::kLanes;
      nodes.emplace_back(rows[row].lane[lane], rows[row + 1].lane[lane], rows[row + 2].lane[lane]);
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

/// Seeded random hairs and motions.
class Random : public math::RandomStream {
 public:
  explicit Random(uint64_t seed) : math::RandomStream(seed, 0) {}

  Vector3d Vector(double size) { return size * Vector3d(Normal(), Normal(), Normal()); }
  Vector3d Direction() { return Vector(1).normalized(); }
  std::vector<Vector3d> Directions(int count) {
    std::vector<Vector3d> e;
    for (int i = 0; i < count; ++i) e.push_back(Direction());
    return e;
  }
  /// A hair on `hull` that is held in a random shape, with some of everything.
  OwnHair AnyHair(int segments, const Hull& hull) {
    OwnHair hair;
    hair.root = hull.center + hull.radii.cwiseProduct(Direction());
    hair.segment_length = Uniform(0.002, 0.02);
    hair.rest = Directions(segments);
    hair.response = ResponseOf(segments * hair.segment_length, segments);
    for (int i = 0; i < segments; ++i) hair.hold.push_back(Uniform(0, 100));
    hair.drag = Uniform(0, 3);
    hair.friction = Uniform(0, 0.05);
    return hair;
  }
  MotionDrive AnyDrive(double dt) {
    MotionDrive drive = Still(Vector(10), dt);
    drive.head = {Vector(1), math::FromRotationVector(Vector(2))};
    drive.velocity_before = Vector(1), drive.velocity = Vector(1);
    drive.spin_before = Vector(5), drive.spin = Vector(5);
    drive.duration_before = dt * Uniform(0.5, 2);
    drive.drag_scale = Uniform(0, 2), drive.friction_scale = Uniform(0, 2);
    drive.frame = Bits() % 100;
    return drive;
  }
};

/// E of B1.
inline double Level(const Hull& hull, const Vector3d& point) {
  return (point - hull.center).cwiseQuotient(hull.radii).squaredNorm() - 1;
}
/// Half of its gradient.
inline Vector3d HalfGradient(const Hull& hull, const Vector3d& point) {
  return (point - hull.center).cwiseQuotient(hull.radii.cwiseProduct(hull.radii));
}

/// The angle between unit vectors [rad].
inline double Angle(const Vector3d& a, const Vector3d& b) {
  return 2 * std::atan2((a - b).norm(), (a + b).norm());
}

}  // namespace mane::beam::fixtures
