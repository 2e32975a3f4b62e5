#pragma once

#include <memory>

#include "base/cancelled.h"
#include "contact/distance.h"
#include "contact/field_grid.h"
#include "contact/mesh.h"
#include "exec/worker_pool.h"

namespace mane::contact {

/// How a field is made.
struct FieldOptions {
  /// Error of the distance [m] up to which cells are not cut further; > 0. Two thirds of it
  /// take more than twice the memory for a human body, most of it in thin parts.
  double tolerance = 3e-4;
  /// The tolerance holds within this distance of the surface [m], >= 0; beyond it grows by a tenth
  /// of the further distance.
  double band = 0.010;
  /// Side of a root cell [m], > 0; less for bodies of a few cells, more for those of very many. The
  /// smallest cells are a 64th of it.
  double root_side = 0.032;
  /// A field of more bytes is refused.
  size_t max_bytes = size_t{512} << 20;
  /// One that takes more work is refused: nanoseconds of one core, about, counted as what searches
  /// look at, so that it does not depend on the machine.
  uint64_t max_work = 40'000'000'000;
  MeshLimits limits;
};

/// Signed distance to a solid bounded by triangles, by interpolation (field_grid.h). Immutable;
/// shared by all who use it.
class MeshField {
 public:
  /// Repairs `mesh` and samples the distance to it.
  ///
  /// @return Repair's errors; INVALID_ARGUMENT naming `triangles` where no triangle bounds a solid;
  ///   RESOURCE_EXHAUSTED above options.max_bytes and max_work; kCancelled soon after `cancelled`
  ///   says so. The same bits for any number of workers.
  [[nodiscard]] static Result<std::shared_ptr<const MeshField>> Build(
      const TriangleMesh& mesh, const FieldOptions& options, exec::WorkerPool* pool,
      const base::Cancelled& cancelled = {});

  /// A field of given numbers, for Build and tests.
  MeshField(FieldGrid grid, const MeshReport& report, double max_error)
      : grid_(std::move(grid)), report_(report), max_error_(max_error) {}

  /// Any point. Outside the grid, which holds the band, the surface point nearest to the grid's
  /// nearest point stands for the surface (D12): the distance is too large there, by no more than
  /// the body. Numbers of a point that is not finite are anything.
  [[nodiscard]] Distance At(const Eigen::Vector3d& point) const;

  /// The same for many points. float32, no locks, no allocation.
  void At(const PointSpans& points, const DistanceSpans& out) const;

  [[nodiscard]] const MeshReport& report() const { return report_; }
  /// Largest deviation from the exact distance [m] that was found within the band, at random
  /// points in every cell there; see (D13) for what may lie between them.
  [[nodiscard]] double max_error() const { return max_error_; }
  [[nodiscard]] size_t bytes() const { return grid_.Bytes(); }
  [[nodiscard]] const FieldGrid& grid() const { return grid_; }

 private:
  FieldGrid grid_;
  MeshReport report_;
  double max_error_;
};

}  // namespace mane::contact
