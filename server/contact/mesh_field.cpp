#include "contact/mesh_field.h"

#include <cmath>
#include <utility>

#include "contact/field_builder.h"
#include "contact/repair.h"
#include "contact/solid_distance.h"

namespace mane::contact {
namespace {

// Gradients shorter than this, where opposite sides are equally near, are no direction.
constexpr float kNoDirection = 1e-6F;

// A grid's numbers in float32, for the loop over points.
struct Lattice {
  explicit Lattice(const FieldGrid& field)
      : grid(field), per_side(static_cast<float>(1 / field.side)) {
    for (int i = 0; i < 3; ++i) {
      origin[i] = static_cast<float>(field.origin[i]);
      cells[i] = static_cast<float>(field.cells[i]);
    }
    side = static_cast<float>(field.side);
  }
  const FieldGrid& grid;
  float origin[3], cells[3];
  float side, per_side;
};

// The direction of the nearest of a cell's corners.
FieldSample NearestCorner(const NodeBlock& block, const float (&share)[3], float d) {
  size_t at[3];
  for (int i = 0; i < 3; ++i) at[i] = std::lround(share[i] * static_cast<float>(block.n));
  const FieldGrid::Node& node = block.first[at[2] * block.layer + at[1] * block.row + at[0]];
  return {d, node.gx, node.gy, node.gz};
}

[[gnu::always_inline]] inline FieldSample Look(const Lattice& lattice, float px, float py,
                                               float pz) {
  const float p[3] = {px, py, pz};
  float share[3], beyond[3];  // Beyond the grid [m].
  int cell[3];
  for (int i = 0; i < 3; ++i) {
    const float x = (p[i] - lattice.origin[i]) * lattice.per_side;
    const float above = x > 0 ? x : 0;  // 0 for NaN.
    const float within = above < lattice.cells[i] ? above : lattice.cells[i];
    const int last = static_cast<int>(lattice.cells[i]) - 1;
    cell[i] = static_cast<int>(within) < last ? static_cast<int>(within) : last;
    share[i] = within - static_cast<float>(cell[i]);
    beyond[i] = (x - within) * lattice.side;
  }
  const FieldGrid& grid = lattice.grid;
  const NodeBlock block = Locate(grid, grid.Root(cell[0], cell[1], cell[2]), share);
  FieldSample sample = Interpolate(block, share[0], share[1], share[2]);
  float squared = sample.gx * sample.gx + sample.gy * sample.gy + sample.gz * sample.gz;
  if (!(squared > kNoDirection)) [[unlikely]] {
    sample = NearestCorner(block, share, sample.d);
    squared = sample.gx * sample.gx + sample.gy * sample.gy + sample.gz * sample.gz;
  }
  const float scale = 1 / std::sqrt(squared);
  sample.gx *= scale;
  sample.gy *= scale;
  sample.gz *= scale;
  if (beyond[0] != 0 || beyond[1] != 0 || beyond[2] != 0) [[unlikely]] {
    const float x = beyond[0] + sample.d * sample.gx;  // From the surface point (D12).
    const float y = beyond[1] + sample.d * sample.gy;
    const float z = beyond[2] + sample.d * sample.gz;
    sample.d = std::sqrt(x * x + y * y + z * z);
    sample.gx = x / sample.d;
    sample.gy = y / sample.d;
    sample.gz = z / sample.d;
  }
  return sample;
}

}  // namespace

Result<std::shared_ptr<const MeshField>> MeshField::Build(const TriangleMesh& mesh,
                                                          const FieldOptions& options,
                                                          exec::WorkerPool* pool) {
  MeshReport report;
  auto solid = Repair(mesh, options.limits, &report);
  if (!solid) return solid.error();
  const SolidDistance truth(*std::move(solid), pool);
  report.buried_triangles = truth.buried();
  if (!truth.has_surface()) {
    return InvalidArgument("triangles",
                           "triangles bound no solid: none has an inside on one side only");
  }
  FieldBuilder builder(truth, options, pool);
  auto grid = builder.Build();
  if (!grid) return grid.error();
  const double max_error = builder.MaxError(*grid);
  return std::shared_ptr<const MeshField>(
      std::make_shared<MeshField>(*std::move(grid), report, max_error));
}

Distance MeshField::At(const Eigen::Vector3d& point) const {
  const FieldSample sample = Look(Lattice(grid_), static_cast<float>(point.x()),
                                  static_cast<float>(point.y()), static_cast<float>(point.z()));
  return {sample.d, Eigen::Vector3d(sample.gx, sample.gy, sample.gz)};
}

void MeshField::At(const PointSpans& points, const DistanceSpans& out) const {
  const Lattice lattice(grid_);
  for (size_t i = 0; i < points.size(); ++i) {
    const FieldSample sample = Look(lattice, points.x[i], points.y[i], points.z[i]);
    out.distance[i] = sample.d;
    out.nx[i] = sample.gx;
    out.ny[i] = sample.gy;
    out.nz[i] = sample.gz;
  }
}

}  // namespace mane::contact
