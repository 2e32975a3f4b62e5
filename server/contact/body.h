#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>

#include "contact/distance.h"
#include "contact/shape.h"
#include "math/rigid.h"

namespace mane::contact {

/// How a bone moves during a step: from one pose to another, along a straight line and the shortest
/// arc, at constant speed. Poses place the bone's frame in the parent's (the world, or a head).
struct BodyMotion {
  math::Pose begin;
  math::Pose end;
  double duration = 0;  ///< [s]; a body does not move where it is 0.

  /// @param fraction  of the step, in [0, 1].
  [[nodiscard]] math::Pose PoseAt(double fraction) const {
    return math::Interpolate(begin, end, fraction);
  }
  /// [m/s], in the parent's axes.
  [[nodiscard]] Eigen::Vector3d LinearVelocity() const;
  /// [rad/s], in the parent's axes; the same all along.
  [[nodiscard]] Eigen::Vector3d AngularVelocity() const;
  /// Velocity [m/s] of the body's material at `point`, both in the parent's frame, at `fraction`.
  [[nodiscard]] Eigen::Vector3d VelocityAt(const Eigen::Vector3d& point, double fraction) const;
};

/// A shape on a bone. A body that deforms by its bones is several of these.
struct Body {
  BodyShape shape;
  BodyMotion motion;
};

/// Where a point stands to several bodies.
struct BodyDistance {
  Distance distance;  ///< To the one in which it is deepest, or that is nearest; parent's axes.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Of that one's material there [m/s].
  int body = -1;                                       ///< Its index; -1 where there is none.
};

/// At `point`, in the parent's frame, at `fraction` of the step. The distance to the union outside
/// of it, and in it where bodies do not overlap; where they do, that to leave one of them. Of
/// equally deep ones the first.
[[nodiscard]] BodyDistance At(std::span<const Body> bodies, double fraction,
                              const Eigen::Vector3d& point);

/// What many points receive; lists as long as the points'.
struct BodyDistanceSpans {
  DistanceSpans distance;
  std::span<float> vx, vy, vz;  ///< [m/s]
  std::span<int32_t> body;
};

/// The same for many points, in float32: `points` in the parent's frame, where rounding grows with
/// their distance from its origin. No locks, no allocation, thread-safe. Without bodies, distances
/// are infinite.
void At(std::span<const Body> bodies, double fraction, const PointSpans& points,
        const BodyDistanceSpans& out);

}  // namespace mane::contact
