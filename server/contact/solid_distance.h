#pragma once

#include <limits>
#include <memory>

#include "contact/closest_triangles.h"
#include "contact/distance.h"
#include "contact/mesh.h"
#include "contact/search_budget.h"
#include "contact/winding.h"
#include "exec/worker_pool.h"

namespace mane::contact {

/// Exact signed distance to the solid that a mesh bounds: the slow truth behind fields.
///
/// The solid is where the winding number is above a half, so pieces may overlap; triangles with
/// solid, or with none, on both sides are buried and no distance is measured to them.
///
/// Where a thread's SearchBudget is over, what it asks is answered at once, with anything.
class SolidDistance {
 public:
  /// @param budget  of the searches that find the surface, which is not all there once it is over;
  ///   null for any number of them.
  SolidDistance(SolidMesh mesh, exec::WorkerPool* pool, SearchBudget* budget = nullptr);

  /// Triangles left out because they are no boundary of the solid.
  [[nodiscard]] int buried() const { return buried_; }
  /// Whether anything bounds the solid; if not, nothing else may be asked.
  [[nodiscard]] bool has_surface() const { return closest_ != nullptr; }
  /// The boundary, facing out of the solid.
  [[nodiscard]] const SolidMesh& surface() const { return surface_; }

  /// The nearest surface point; see ClosestTriangles::Find.
  [[nodiscard]] ClosestTriangles::Hit Closest(const Eigen::Vector3d& point, double within) const {
    if (SearchBudget::Over()) return {0, point, 0};
    return closest_->Find(point, within);
  }
  [[nodiscard]] bool Inside(const Eigen::Vector3d& point) const {
    return !SearchBudget::Over() && winding_.Inside(point);
  }

  /// Direction of growing distance at `point`, whose nearest surface point is `hit`; on the surface
  /// the triangle's normal.
  [[nodiscard]] Eigen::Vector3d Normal(const Eigen::Vector3d& point,
                                       const ClosestTriangles::Hit& hit, bool inside) const;

  /// Distance and normal: a nearest point search and a winding number.
  /// @param within  see Closest.
  [[nodiscard]] Distance At(const Eigen::Vector3d& point,
                            double within = std::numeric_limits<double>::infinity()) const;

 private:
  [[nodiscard]] SolidMesh Surface(exec::WorkerPool* pool, SearchBudget* budget) const;

  const SolidMesh mesh_;
  const WindingTree winding_;
  const SolidMesh surface_;
  const int buried_;
  const std::unique_ptr<ClosestTriangles> closest_;
};

}  // namespace mane::contact
