#include "wire/reconstruct.h"

#include <cstddef>

#include "base/check.h"
#include "math/stumpff.h"

namespace mane::wire {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Material frame and centreline point where an element starts.
struct ElementFrame {
  Matrix3d R;
  Vector3d r;
};

// r(u): the part `u` of an element of length `l` and angles `theta`.
Vector3d PointAt(const ElementFrame& f, double l, const Vector3d& theta, double u) {
  const Vector3d phi = u * theta;
  const auto c = math::StumpffC(phi.squaredNorm());
  const Vector3d turn = phi.cross(Vector3d::UnitX());
  const Vector3d chord = Vector3d::UnitX() + c[2] * turn + c[3] * phi.cross(turn);
  return f.r + u * l * (f.R * chord);
}

ElementFrame EndOf(const ElementFrame& f, double l, const Vector3d& theta) {
  const auto c = math::StumpffC(theta.squaredNorm());
  const Matrix3d K = math::Cross(theta);
  return {f.R * (Matrix3d::Identity() + c[1] * K + c[2] * (K * K)), PointAt(f, l, theta, 1)};
}

template <typename Point>
void Sample(const math::Pose& root, std::span<const double> lengths,
            std::span<const Vector3d> theta, std::span<Point> out) {
  MANE_CHECK(!lengths.empty() && lengths.size() == theta.size() && out.size() >= 2);
  double total = 0;
  for (const double l : lengths) total += l;

  ElementFrame f{root.q.toRotationMatrix(), root.p};
  const size_t last = out.size() - 1;
  const double spacing = total / static_cast<double>(last);
  double start = 0;
  size_t i = 0;
  for (size_t q = 0; q < lengths.size(); ++q) {
    for (; i < last; ++i) {
      const double u = (static_cast<double>(i) * spacing - start) / lengths[q];
      if (u > 1) break;
      out[i] = PointAt(f, lengths[q], theta[q], u).template cast<typename Point::Scalar>();
    }
    f = EndOf(f, lengths[q], theta[q]);
    start += lengths[q];
  }
  // Rounding of the sums can leave points within an ulp of the tip unvisited.
  for (; i <= last; ++i) out[i] = f.r.template cast<typename Point::Scalar>();
}

}  // namespace

void SamplePoints(const math::Pose& root, std::span<const double> lengths,
                  std::span<const Vector3d> theta, std::span<Vector3d> out) {
  Sample(root, lengths, theta, out);
}

void SamplePoints(const math::Pose& root, std::span<const double> lengths,
                  std::span<const Vector3d> theta, std::span<Eigen::Vector3f> out) {
  Sample(root, lengths, theta, out);
}

}  // namespace mane::wire
