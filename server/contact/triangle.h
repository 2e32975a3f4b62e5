#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mane::contact {

/// A triangle made ready for many questions.
struct PreparedTriangle {
  PreparedTriangle(const Eigen::Vector3d& corner_a, const Eigen::Vector3d& corner_b,
                   const Eigen::Vector3d& corner_c)
      : a(corner_a), ab(corner_b - corner_a), ac(corner_c - corner_a) {
    const Eigen::Vector3d area = ab.cross(ac);
    const double size = area.norm();
    has_area = size > 1e-12 * std::max(ab.squaredNorm(), ac.squaredNorm());
    n = has_area ? Eigen::Vector3d(area / size) : Eigen::Vector3d(Eigen::Vector3d::Zero());
  }

  Eigen::Vector3d a, ab, ac;
  Eigen::Vector3d n;  ///< Unit normal; zero without area.
  bool has_area;
};

/// The point of the segment from `a` along `e` nearest to `p`; `a` where e is zero.
[[nodiscard]] inline Eigen::Vector3d ClosestOnSegment(const Eigen::Vector3d& p,
                                                      const Eigen::Vector3d& a,
                                                      const Eigen::Vector3d& e) {
  const double squared = e.squaredNorm();
  if (!(squared > 0)) return a;
  return a + std::clamp((p - a).dot(e) / squared, 0.0, 1.0) * e;
}

/// The point of a triangle nearest to `p` (D5); one without area is its sides.
[[nodiscard]] inline Eigen::Vector3d ClosestOnTriangle(const Eigen::Vector3d& p,
                                                       const PreparedTriangle& t) {
  const Eigen::Vector3d d = p - t.a;
  // Barycentric coordinates of the foot on the plane, times twice the area.
  const double v = d.cross(t.ac).dot(t.n), w = t.ab.cross(d).dot(t.n);
  const double u = t.ab.cross(t.ac).dot(t.n) - v - w;
  if (t.has_area && u >= 0 && v >= 0 && w >= 0) return p - d.dot(t.n) * t.n;
  // Otherwise it lies on a side, and where there is an area on one that has p beyond it.
  Eigen::Vector3d best = t.a;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](const Eigen::Vector3d& start, const Eigen::Vector3d& side) {
    const Eigen::Vector3d other = ClosestOnSegment(p, start, side);
    const double squared = (other - p).squaredNorm();
    if (squared < least) {
      least = squared;
      best = other;
    }
  };
  if (!t.has_area || w < 0) consider(t.a, t.ab);
  if (!t.has_area || v < 0) consider(t.a, t.ac);
  if (!t.has_area || u < 0) consider(t.a + t.ab, t.ac - t.ab);
  return best;
}

/// Solid angle [rad] under which `p` sees the triangle a b c, positive from behind; (D6).
[[nodiscard]] inline double SolidAngle(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                       const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d x = a - p, y = b - p, z = c - p;
  const double lx = x.norm(), ly = y.norm(), lz = z.norm();
  const double below = lx * ly * lz + x.dot(y) * lz + y.dot(z) * lx + z.dot(x) * ly;
  return 2 * std::atan2(x.dot(y.cross(z)), below);
}

}  // namespace mane::contact
