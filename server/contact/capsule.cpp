#include "contact/capsule.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace mane::contact {
namespace {

// What (D4) needs of a capsule, as numbers of one type.
template <typename T>
struct Segment {
  explicit Segment(const Capsule& capsule) {
    const Eigen::Vector3d along = capsule.b() - capsule.a();
    const double squared = along.squaredNorm();
    const Eigen::Vector3d side =
        squared > 0 ? along.unitOrthogonal() : Eigen::Vector3d(Eigen::Vector3d::UnitY());
    for (int i = 0; i < 3; ++i) {
      a[i] = static_cast<T>(capsule.a()[i]);
      e[i] = static_cast<T>(along[i]);
      across[i] = static_cast<T>(side[i]);
    }
    inverse = squared > 0 ? static_cast<T>(1 / squared) : T(0);
    radius = static_cast<T>(capsule.radius());
  }
  T a[3], e[3], across[3];
  T inverse;  // 1 / |e|^2; 0 for a sphere.
  T radius;
};

template <typename T>
[[gnu::always_inline]] inline T Solve(const Segment<T>& segment, const T (&p)[3], T (&n)[3]) {
  T along = 0, d[3], squared = 0;
  for (int i = 0; i < 3; ++i) along += (p[i] - segment.a[i]) * segment.e[i];
  const T u = std::min(T(1), std::max(T(0), along * segment.inverse));
  for (int i = 0; i < 3; ++i) {
    d[i] = p[i] - segment.a[i] - u * segment.e[i];
    squared += d[i] * d[i];
  }
  const T length = std::sqrt(squared);
  const bool on_segment = !(length > 0);
  const T scale = on_segment ? T(0) : 1 / length;
  for (int i = 0; i < 3; ++i) n[i] = on_segment ? segment.across[i] : d[i] * scale;
  return length - segment.radius;
}

}  // namespace

Distance Capsule::At(const Eigen::Vector3d& point) const {
  const double p[3] = {point.x(), point.y(), point.z()};
  double n[3];
  Distance out;
  out.distance = Solve(Segment<double>(*this), p, n);
  out.normal = {n[0], n[1], n[2]};
  return out;
}

void Capsule::At(const PointSpans& points, const DistanceSpans& out) const {
  const Segment<float> segment(*this);
  for (size_t i = 0; i < points.size(); ++i) {
    const float p[3] = {points.x[i], points.y[i], points.z[i]};
    float n[3];
    out.distance[i] = Solve(segment, p, n);
    out.nx[i] = n[0];
    out.ny[i] = n[1];
    out.nz[i] = n[2];
  }
}

}  // namespace mane::contact
