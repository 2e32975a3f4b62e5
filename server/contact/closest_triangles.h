#pragma once

#include <memory>

#include "contact/mesh.h"

namespace mane::contact {

/// Exact nearest points on a set of triangles, by Embree's hierarchy and point queries.
class ClosestTriangles {
 public:
  struct Hit {
    double distance;        ///< [m]
    Eigen::Vector3d point;  ///< On the triangle [m].
    int triangle;
  };

  /// @param mesh  its vertices are float32 numbers, so that Embree's boxes hold them.
  explicit ClosestTriangles(const SolidMesh& mesh);
  ~ClosestTriangles();
  ClosestTriangles(const ClosestTriangles&) = delete;
  ClosestTriangles& operator=(const ClosestTriangles&) = delete;

  /// The nearest point of all, in double precision; of equally near triangles the first. The same
  /// whatever hierarchy was built.
  ///
  /// @param within  a bound on the distance [m], which makes the search short; where nothing lies
  /// within it, the search is repeated without. Thread-safe, no allocation. Counted by the thread's
  /// SearchBudget.
  [[nodiscard]] Hit Find(const Eigen::Vector3d& point, double within) const;

 private:
  struct Scene;
  std::unique_ptr<Scene> scene_;
};

}  // namespace mane::contact
