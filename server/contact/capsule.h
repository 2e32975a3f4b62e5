#pragma once

#include "contact/distance.h"

namespace mane::contact {

/// All points within `radius` of the segment from `a` to `b`; a sphere where these are equal.
/// Exact: |y - c| - radius, with c the segment's point nearest to y (D4).
class Capsule {
 public:
  /// @param a,b  ends of the segment [m]. @param radius  [m], positive.
  Capsule(const Eigen::Vector3d& a, const Eigen::Vector3d& b, double radius)
      : a_(a), b_(b), radius_(radius) {}

  [[nodiscard]] const Eigen::Vector3d& a() const { return a_; }
  [[nodiscard]] const Eigen::Vector3d& b() const { return b_; }
  [[nodiscard]] double radius() const { return radius_; }

  /// On the segment itself the normal is one across it.
  [[nodiscard]] Distance At(const Eigen::Vector3d& point) const;

  /// The same in float32. No allocation, thread-safe.
  void At(const PointSpans& points, const DistanceSpans& out) const;

 private:
  Eigen::Vector3d a_, b_;
  double radius_;
};

}  // namespace mane::contact
