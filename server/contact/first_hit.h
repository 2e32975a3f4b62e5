#pragma once

#include <memory>
#include <optional>

#include "contact/mesh.h"

namespace mane::contact {

/// Where lines first meet a set of triangles, by Embree's hierarchy. Immutable; any thread may ask.
class FirstHit {
 public:
  /// @param vertices   float32 numbers [m]. @param triangles  at least one, seen from both sides.
  FirstHit(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles);
  ~FirstHit();
  FirstHit(const FirstHit&) = delete;
  FirstHit& operator=(const FirstHit&) = delete;

  /// The first point of the way from `from` to `to` [m] that lies on a triangle, to float32; none
  /// where it meets none. O(log triangles), no allocation.
  [[nodiscard]] std::optional<Eigen::Vector3d> Find(const Eigen::Vector3d& from,
                                                    const Eigen::Vector3d& to) const;

 private:
  std::unique_ptr<class EmbreeScene> scene_;
};

}  // namespace mane::contact
