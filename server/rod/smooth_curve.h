#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace mane::rod {

/// A twice differentiable curve through the smoothed points of a polyline, by arc length: what a
/// fit starts from (rod.md, F1, F2).
class SmoothCurve {
 public:
  /// @param points  at least two, no two neighbours equal, finite, of size about one: the
  ///                smoothing searches a fixed range.
  /// @param noise   standard deviation of each coordinate; negative: to be estimated by generalised
  ///                cross-validation, which needs ten points and takes fewer as exact.
  SmoothCurve(std::span<const Eigen::Vector3d> points, double noise);

  [[nodiscard]] double length() const { return arc_.back(); }
  /// Of the polyline through the smoothed points.
  [[nodiscard]] double chord_length() const { return knot_.back(); }
  /// Given or estimated standard deviation of a coordinate.
  [[nodiscard]] double noise() const { return noise_; }
  /// Arc length at each point, (n), increasing.
  [[nodiscard]] std::span<const double> arc() const { return arc_; }

  [[nodiscard]] Eigen::Vector3d At(double s) const;
  [[nodiscard]] Eigen::Vector3d Tangent(double s) const;  ///< Of unit length.

 private:
  struct Location {
    int segment;
    double u;
  };
  void Smooth();
  void Interpolate();
  [[nodiscard]] Location Locate(double s) const;
  [[nodiscard]] Eigen::Vector3d Position(Location at) const;
  [[nodiscard]] Eigen::Vector3d Derivative(Location at) const;
  [[nodiscard]] double ArcWithin(int segment, double u) const;

  double noise_;
  std::vector<Eigen::Vector3d> point_, slope_;  // Of the spline over the chord length `knot_`.
  std::vector<double> knot_, arc_;
};

}  // namespace mane::rod
