#include "contact/mesh_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "contact/field_builder.h"
#include "contact/repair.h"
#include "contact/solid_distance.h"

namespace mane::contact {
namespace {

// Gradients shorter than this, where opposite sides are equally near, are no direction.
constexpr float kNoDirection = 1e-6F;

// Points whose places are found before the first is looked at.
constexpr size_t kAhead = 16;

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

// A point's place in the field.
struct Place {
  NodeBlock block;
  float share[3];   // Of the block.
  float beyond[3];  // The grid [m].
};

[[gnu::always_inline]] inline Place Find(const Lattice& lattice, float px, float py, float pz) {
  const float p[3] = {px, py, pz};
  Place place;
  int cell[3];
  for (int i = 0; i < 3; ++i) {
    const float x = (p[i] - lattice.origin[i]) * lattice.per_side;
    const float above = x > 0 ? x : 0;  // 0 for NaN.
    const float within = above < lattice.cells[i] ? above : lattice.cells[i];
    const int last = static_cast<int>(lattice.cells[i]) - 1;
    cell[i] = static_cast<int>(within) < last ? static_cast<int>(within) : last;
    place.share[i] = within - static_cast<float>(cell[i]);
    place.beyond[i] = (x - within) * lattice.side;
  }
  const FieldGrid& grid = lattice.grid;
  place.block = Locate(grid, grid.Root(cell[0], cell[1], cell[2]), place.share);
  return place;
}

[[gnu::always_inline]] inline FieldSample Look(const Place& place) {
  const float(&share)[3] = place.share;
  const float(&beyond)[3] = place.beyond;
  FieldSample sample = Interpolate(place.block, share[0], share[1], share[2]);
  float squared = sample.gx * sample.gx + sample.gy * sample.gy + sample.gz * sample.gz;
  if (!(squared > kNoDirection)) [[unlikely]] {
    sample = NearestCorner(place.block, share, sample.d);
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
                                                          exec::WorkerPool* pool,
                                                          const base::Cancelled& cancelled) {
  MeshReport report;
  auto solid = Repair(mesh, options.limits, &report);
  if (!solid) return solid.error();
  SearchBudget budget(options.max_work, cancelled);
  const SolidDistance truth(*std::move(solid), pool, &budget);
  if (auto within = budget.Check(); !within) return within.error();
  report.buried_triangles = truth.buried();
  if (!truth.has_surface()) {
    return InvalidArgument("triangles",
                           "triangles bound no solid: none has an inside on one side only");
  }
  FieldBuilder builder(truth, options, pool, &budget);
  auto grid = builder.Build();
  if (!grid) return grid.error();
  const double max_error = builder.MaxError(*grid);
  if (auto within = budget.Check(); !within) return within.error();
  return std::shared_ptr<const MeshField>(
      std::make_shared<MeshField>(*std::move(grid), report, max_error));
}

Distance MeshField::At(const Eigen::Vector3d& point) const {
  const Lattice lattice(grid_);
  const FieldSample sample =
      Look(Find(lattice, static_cast<float>(point.x()), static_cast<float>(point.y()),
                static_cast<float>(point.z())));
  return {sample.d, Eigen::Vector3d(sample.gx, sample.gy, sample.gz)};
}

void MeshField::At(const PointSpans& points, const DistanceSpans& out) const {
  const Lattice lattice(grid_);
  // First where points lie, then what is there: memory brings the corners of all of them at once.
  std::array<Place, kAhead> places;
  for (size_t begin = 0; begin < points.size(); begin += kAhead) {
    const size_t count = std::min(kAhead, points.size() - begin);
    for (size_t i = 0; i < count; ++i) {
      const size_t p = begin + i;
      places[i] = Find(lattice, points.x[p], points.y[p], points.z[p]);
      Prefetch(places[i].block, places[i].share);
    }
    for (size_t i = 0; i < count; ++i) {
      const size_t p = begin + i;
      const FieldSample sample = Look(places[i]);
      out.distance[p] = sample.d;
      out.nx[p] = sample.gx;
      out.ny[p] = sample.gy;
      out.nz[p] = sample.gz;
    }
  }
}

}  // namespace mane::contact
