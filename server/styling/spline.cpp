#include "styling/spline.h"

#include <algorithm>

namespace mane::styling {

using Eigen::Vector3d;

template <typename Scalar>
typename Spline<Scalar>::Place Spline<Scalar>::Find(double s) const {
  const double x = std::clamp(s, 0.0, 1.0) * spans();
  const int span = std::min(static_cast<int>(x), spans() - 1);
  return {span, x - span};
}

template <typename Scalar>
Vector3d Spline<Scalar>::M(int i) const {
  const int last = spans();
  if (last == 1) return P(1) - P(0);
  if (i == 0) return (-3 * P(0) + 4 * P(1) - P(2)) / 2;
  if (i == last) return (3 * P(last) - 4 * P(last - 1) + P(last - 2)) / 2;
  return (P(i + 1) - P(i - 1)) / 2;
}

template <typename Scalar>
Vector3d Spline<Scalar>::At(Place place) const {
  const auto [i, t] = place;
  if (t == 0) return P(i);
  if (t == 1) return P(i + 1);
  const double t2 = t * t, t3 = t2 * t;  // Hermite's form of (W1).
  return (1 - 3 * t2 + 2 * t3) * P(i) + (3 * t2 - 2 * t3) * P(i + 1) + (t - 2 * t2 + t3) * M(i) +
         (t3 - t2) * M(i + 1);
}

template <typename Scalar>
Vector3d Spline<Scalar>::At(double s) const {
  return spans() == 0 ? P(0) : At(Find(s));
}

template <typename Scalar>
Vector3d Spline<Scalar>::Tangent(double s) const {
  if (spans() == 0) return Vector3d::Zero();
  const auto [i, t] = Find(s);
  const double t2 = t * t;
  const Vector3d per_span =
      6 * (t - t2) * (P(i + 1) - P(i)) + (1 - 4 * t + 3 * t2) * M(i) + (3 * t2 - 2 * t) * M(i + 1);
  return per_span * spans();
}

template <typename Scalar>
std::vector<Vector3d> Spline<Scalar>::Polyline(int per_span) const {
  std::vector<Vector3d> points;
  points.reserve(static_cast<size_t>(spans()) * per_span + 1);
  for (int i = 0; i < spans(); ++i) {
    for (int j = 0; j < per_span; ++j)
      points.push_back(At(Place{i, static_cast<double>(j) / per_span}));
  }
  points.push_back(P(spans()));
  return points;
}

template class Spline<float>;
template class Spline<double>;

double Length(std::span<const Vector3d> polyline) {
  double length = 0;
  for (size_t i = 1; i < polyline.size(); ++i) length += (polyline[i] - polyline[i - 1]).norm();
  return length;
}

std::vector<Vector3d> Resample(std::span<const Vector3d> polyline, int k) {
  const double step = Length(polyline) / (k - 1);
  std::vector<Vector3d> points(k, polyline.front());
  if (step == 0) return points;
  double begin = 0;  // Arc length at the beginning of segment i.
  int next = 1;
  for (size_t i = 0; i + 1 < polyline.size(); ++i) {
    const Vector3d along = polyline[i + 1] - polyline[i];
    const double length = along.norm();
    for (; next < k - 1 && next * step <= begin + length && length > 0; ++next) {
      points[next] = polyline[i] + (next * step - begin) / length * along;
    }
    begin += length;
  }
  points.back() = polyline.back();
  return points;
}

}  // namespace mane::styling
