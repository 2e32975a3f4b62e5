#pragma once

#include <Eigen/Core>

#include <span>

namespace mane::contact {

/// Where a point stands to a body's surface.
struct Distance {
  double distance = 0;  ///< [m], negative inside.
  /// Gradient of the distance: a unit vector, out of the body. Where several surface points are
  /// nearest the gradient does not exist, and this is the direction that belongs to one of them.
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
};

/// Many points as three lists of equal length [m].
struct PointSpans {
  std::span<const float> x, y, z;

  [[nodiscard]] size_t size() const { return x.size(); }
  [[nodiscard]] PointSpans Part(size_t begin, size_t count) const {
    return {x.subspan(begin, count), y.subspan(begin, count), z.subspan(begin, count)};
  }
};

/// The distances [m] and normals of many points, each as long as the points' lists.
struct DistanceSpans {
  std::span<float> distance, nx, ny, nz;

  [[nodiscard]] DistanceSpans Part(size_t begin, size_t count) const {
    return {distance.subspan(begin, count), nx.subspan(begin, count), ny.subspan(begin, count),
            nz.subspan(begin, count)};
  }
};

}  // namespace mane::contact
