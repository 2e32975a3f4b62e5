#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

namespace mane::styling {

/// Catmull-Rom spline through control points ([CK05] 2.1), wisps.md (W1): knots at equal steps of
/// s in [0, 1], p(0) the first point and p(1) the last. Once continuously differentiable; commutes
/// with affine maps.
///
/// The end tangents, of which the paper says nothing, are those of the parabola through the three
/// points there (two points make a straight line), so that a strand bends on to its tip instead of
/// straightening out.
///
/// Holds no copy: the points must outlive it. Evaluates in double; Scalar is float or double.
template <typename Scalar>
class Spline {
 public:
  using Point = Eigen::Matrix<Scalar, 3, 1>;

  /// @param points  one or more.
  explicit Spline(std::span<const Point> points) : points_(points) {}

  /// p(s); s outside [0, 1] is taken as the nearer end.
  [[nodiscard]] Eigen::Vector3d At(double s) const;
  /// dp/ds there.
  [[nodiscard]] Eigen::Vector3d Tangent(double s) const;
  /// The spline's points at `per_span` equal steps of every span, ends included; per_span >= 1.
  [[nodiscard]] std::vector<Eigen::Vector3d> Polyline(int per_span) const;

 private:
  struct Place {
    int span;
    double t;
  };
  [[nodiscard]] int spans() const { return static_cast<int>(points_.size()) - 1; }
  [[nodiscard]] Place Find(double s) const;
  [[nodiscard]] Eigen::Vector3d P(int i) const { return points_[i].template cast<double>(); }
  // Tangent at knot i, per span.
  [[nodiscard]] Eigen::Vector3d M(int i) const;
  [[nodiscard]] Eigen::Vector3d At(Place place) const;

  std::span<const Point> points_;
};

extern template class Spline<float>;
extern template class Spline<double>;

/// Length of a polyline [m].
[[nodiscard]] double Length(std::span<const Eigen::Vector3d> polyline);

/// `k` points of a polyline at equal arc length, both ends among them and exact. One point, or
/// length zero, repeats the first. Give Spline::Polyline to resample a spline.
///
/// @param polyline  one point or more.
/// @param k         >= 2.
[[nodiscard]] std::vector<Eigen::Vector3d> Resample(std::span<const Eigen::Vector3d> polyline,
                                                    int k);

}  // namespace mane::styling
