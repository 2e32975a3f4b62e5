#include "styling/density_field.h"

#include <algorithm>
#include <atomic>
#include <cmath>

namespace mane::styling {
namespace {

using Eigen::AlignedBox3d;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector3i;

constexpr double kMostNodes = 4e6;
constexpr double kCellsOfRadius = 2;  // A wisp's radius in cells, at most.
constexpr int kMargin = 2;            // Cells around hair, and around the solid.
// (D5): a kernel 1 - (d/R)^2 of this R / r has a full tube's second moment.
constexpr float kKernelWidth = 1.2247449f;

// Corners whose solid is farther than this many cells tell that a point is not within a quarter of
// a cell: no point of a cell is farther than sqrt(3)/2 from its nearest corner, and a mesh's
// distance may be wrong by a tenth of it.
constexpr float kNearDepth = 0.5f - 1.25f;

float Solid(float depth) { return std::clamp(depth, 0.0f, 1.0f); }

AlignedBox3d Bounds(const contact::Ellipsoid& ellipsoid) {
  return {-ellipsoid.radii(), ellipsoid.radii()};
}
AlignedBox3d Bounds(const contact::Capsule& capsule) {
  const Vector3d radius = Vector3d::Constant(capsule.radius());
  return {capsule.a().cwiseMin(capsule.b()) - radius, capsule.a().cwiseMax(capsule.b()) + radius};
}
AlignedBox3d Bounds(const std::shared_ptr<const contact::MeshField>& mesh) {
  const contact::FieldGrid& grid = mesh->grid();
  const Vector3d low(grid.origin[0], grid.origin[1], grid.origin[2]);
  const Vector3d cells(grid.cells[0], grid.cells[1], grid.cells[2]);
  return {low, low + grid.side * cells};
}

// Of an obstacle, in the head frame.
AlignedBox3d Bounds(const Obstacle& obstacle) {
  const AlignedBox3d own =
      std::visit([](const auto& shape) { return Bounds(shape); }, obstacle.shape);
  AlignedBox3d bounds;
  for (int k = 0; k < 8; ++k) {
    bounds.extend(obstacle.pose * own.corner(static_cast<AlignedBox3d::CornerType>(k)));
  }
  return bounds;
}

// Distance from a segment, squared; what of it does not change with the point is made once.
struct ToSegment {
  explicit ToSegment(const DensityField::Segment& segment)
      : from(segment.from), along(segment.to - segment.from) {
    const float squared = along.squaredNorm();
    inverse = squared > 0 ? 1 / squared : 0;
  }
  [[gnu::always_inline]] float operator()(float x, float y, float z) const {
    const float dx = x - from[0], dy = y - from[1], dz = z - from[2];
    float t = (dx * along[0] + dy * along[1] + dz * along[2]) * inverse;
    t = t < 0 ? 0 : t > 1 ? 1 : t;
    const float ex = dx - t * along[0], ey = dy - t * along[1], ez = dz - t * along[2];
    return ex * ex + ey * ey + ez * ez;
  }
  Vector3f from, along;
  float inverse;
};

}  // namespace

GridBox BoxOver(const Eigen::AlignedBox3f& hair, double cell, double radius) {
  const Vector3d size = hair.sizes().cast<double>();
  double h = std::max(cell, radius / kCellsOfRadius);
  const auto nodes = [&] { return Vector3d((size / h).array().ceil() + (1 + 2 * kMargin)); };
  while (nodes().prod() > kMostNodes) h *= 1.01;
  GridBox box;
  box.cell = static_cast<float>(h);
  box.nodes = nodes().cast<int>();
  box.low = hair.min() - Vector3f::Constant(kMargin * box.cell);
  return box;
}

float DensityField::Stencil::Value(const std::array<float, 8>& v) const {
  const float x = fraction.x(), y = fraction.y(), z = fraction.z();
  const float a = v[0] + x * (v[1] - v[0]), b = v[2] + x * (v[3] - v[2]);
  const float c = v[4] + x * (v[5] - v[4]), d = v[6] + x * (v[7] - v[6]);
  const float low = a + y * (b - a), high = c + y * (d - c);
  return low + z * (high - low);
}

Vector3f DensityField::Stencil::Slope(const std::array<float, 8>& v) const {
  const float x = fraction.x(), y = fraction.y(), z = fraction.z();
  const auto mix = [](float low, float high, float share) { return low + share * (high - low); };
  const float along_x = mix(mix(v[1] - v[0], v[3] - v[2], y), mix(v[5] - v[4], v[7] - v[6], y), z);
  const float along_y = mix(mix(v[2] - v[0], v[3] - v[1], x), mix(v[6] - v[4], v[7] - v[5], x), z);
  const float along_z = mix(mix(v[4] - v[0], v[5] - v[1], x), mix(v[6] - v[2], v[7] - v[3], x), y);
  return Vector3f(along_x, along_y, along_z) / cell;
}

Result<DensityField> DensityField::Make(const GridBox& box, const Obstacles& obstacles,
                                        exec::WorkerPool* pool, const base::Cancelled& cancelled) {
  DensityField field(box);
  for (const Obstacle& obstacle : obstacles) {
    field.AddSolid(obstacle, pool, cancelled);
    if (base::IsCancelled(cancelled)) return base::CancelledError();
  }
  return field;
}

void DensityField::AddSolid(const Obstacle& obstacle, exec::WorkerPool* pool,
                            const base::Cancelled& cancelled) {
  const AlignedBox3d bounds = Bounds(obstacle);
  const Vector3d low = box_.low.cast<double>();
  const Vector3d margin = Vector3d::Constant(kMargin);
  const Vector3d last = box_.nodes.cast<double>();
  const auto node = [&](const Vector3d& at) -> Vector3i {
    return at.cwiseMax(0).cwiseMin(last).cast<int>();
  };
  const Vector3i begin = node(((bounds.min() - low) / box_.cell - margin).array().floor());
  const Vector3i end = node(((bounds.max() - low) / box_.cell + margin).array().ceil() + 1);
  pool->ParallelFor(end.z() - begin.z(), 1, [&](int layer, int) {
    if (base::IsCancelled(cancelled)) return;
    for (int y = begin.y(); y < end.y(); ++y) {
      AddSolidRow(obstacle, y, begin.z() + layer, begin.x(), end.x());
    }
  });
}

void DensityField::AddSolidRow(const Obstacle& obstacle, int y, int z, int begin, int end) {
  constexpr int kAtOnce = 64;
  const math::Pose to_shape = obstacle.pose.Inverse();
  const Vector3f origin = (to_shape * box_.low.cast<double>()).cast<float>();
  const Eigen::Matrix3f axes = to_shape.q.toRotationMatrix().cast<float>() * box_.cell;
  std::array<float, kAtOnce> px, py, pz, d, nx, ny, nz;
  for (int x = begin; x < end; x += kAtOnce) {
    const auto count = static_cast<size_t>(std::min(kAtOnce, end - x));
    for (size_t i = 0; i < count; ++i) {
      const Vector3f p = origin + axes * Vector3f(static_cast<float>(x + static_cast<int>(i)),
                                                  static_cast<float>(y), static_cast<float>(z));
      px[i] = p.x();
      py[i] = p.y();
      pz[i] = p.z();
    }
    contact::At(obstacle.shape, {{px.data(), count}, {py.data(), count}, {pz.data(), count}},
                {{d.data(), count}, {nx.data(), count}, {ny.data(), count}, {nz.data(), count}});
    Node* row = &nodes_[Index(x, y, z)];
    for (size_t i = 0; i < count; ++i) {
      row[i].depth = std::max(row[i].depth, 0.5f - d[i] / box_.cell);
    }
  }
}

DensityField::Stencil DensityField::Look(const Vector3f& x) const {
  Stencil stencil;
  stencil.cell = box_.cell;
  const Vector3f place = (x - box_.low) / box_.cell;
  const Vector3f last = (box_.nodes.array() - 1).cast<float>();
  if (!(place.array() >= 0).all() || !(place.array() < last.array()).all()) {
    stencil.first = x;
    stencil.fraction.setZero();
    stencil.near_solid = true;
    stencil.hair.fill(0);
    stencil.solid.fill(0);
    return stencil;
  }
  const Vector3i cell = place.cast<int>();
  stencil.fraction = place - cell.cast<float>();
  stencil.first = box_.low + box_.cell * cell.cast<float>();
  const size_t row = static_cast<size_t>(box_.nodes.x());
  const size_t layer = row * static_cast<size_t>(box_.nodes.y());
  const Node* node = &nodes_[Index(cell.x(), cell.y(), cell.z())];
  float depth = kFar;
  for (size_t k = 0; k < 8; ++k) {
    const Node& corner = node[(k & 1) + (k >> 1 & 1) * row + (k >> 2) * layer];
    stencil.hair[k] = corner.hair;
    stencil.solid[k] = Solid(corner.depth);
    depth = std::max(depth, corner.depth);
  }
  stencil.near_solid = depth > kNearDepth;
  return stencil;
}

float DensityField::At(const Vector3f& x) const {
  const Stencil stencil = Look(x);
  return stencil.Value(stencil.hair) + stencil.Value(stencil.solid);
}

Vector3f DensityField::SlopeAt(const Vector3f& x) const {
  const Stencil stencil = Look(x);
  return stencil.Slope(stencil.hair) + stencil.Slope(stencil.solid);
}

std::vector<float> DensityField::Values() const {
  std::vector<float> values(nodes_.size());
  std::ranges::transform(nodes_, values.begin(),
                         [](const Node& node) { return node.hair + Solid(node.depth); });
  return values;
}

float DensityField::Reach(float radius) const { return kKernelWidth * std::max(radius, box_.cell); }

// Calls visit(node, k) for the nodes that the kernel reaches.
template <typename Visit>
int64_t DensityField::ForNodes(const Segment& segment, const Visit& visit) const {
  const float h = box_.cell, R = Reach(segment.radius);
  const Vector3f reach = Vector3f::Constant(R);
  const Vector3f low = (segment.from.cwiseMin(segment.to) - reach - box_.low) / h;
  const Vector3f high = (segment.from.cwiseMax(segment.to) + reach - box_.low) / h;
  const Vector3f last = (box_.nodes.array() - 1).cast<float>();
  const Vector3i begin = low.array().ceil().max(0).min(last.array() + 1).cast<int>();
  const Vector3i end = high.array().floor().max(-1).min(last.array()).cast<int>();
  const ToSegment distance(segment);
  const float per_R2 = 1 / (R * R);
  for (int z = begin.z(); z <= end.z(); ++z) {
    for (int y = begin.y(); y <= end.y(); ++y) {
      const size_t row = Index(0, y, z);
      const float at_y = box_.low.y() + h * static_cast<float>(y);
      const float at_z = box_.low.z() + h * static_cast<float>(z);
      for (int x = begin.x(); x <= end.x(); ++x) {
        const float at_x = box_.low.x() + h * static_cast<float>(x);
        const float k = 1 - distance(at_x, at_y, at_z) * per_R2;
        if (k > 0) visit(row + static_cast<size_t>(x), k);
      }
    }
  }
  const Vector3i sides = (end - begin + Vector3i(1, 1, 1)).cwiseMax(0);
  return static_cast<int64_t>(sides.x()) * sides.y() * sides.z();
}

float DensityField::Scale(const Segment& segment) const {
  float sum = 0;
  ForNodes(segment, [&](size_t n, float k) { sum += k * (1 - Solid(nodes_[n].depth)); });
  const float h3 = box_.cell * box_.cell * box_.cell;
  return sum > 0 ? segment.volume / (sum * h3) : 0;
}

int64_t DensityField::Deposit(const Segment& segment, float scale) {
  return ForNodes(segment, [&](size_t n, float k) {
    nodes_[n].hair += scale * k * (1 - Solid(nodes_[n].depth));
  });
}

void DensityField::Increase(const Segment& segment, float scale, const Stencil& at,
                            std::array<float, 8>* corners) const {
  const float R = Reach(segment.radius);
  const float per_R2 = 1 / (R * R);
  const ToSegment distance(segment);
  for (size_t i = 0; i < 8; ++i) {
    const float x = at.first.x() + (i & 1 ? at.cell : 0);
    const float y = at.first.y() + (i & 2 ? at.cell : 0);
    const float z = at.first.z() + (i & 4 ? at.cell : 0);
    const float k = 1 - distance(x, y, z) * per_R2;
    (*corners)[i] = k > 0 ? scale * k * (1 - at.solid[i]) : 0;
  }
}

float DensityField::Increase(const Segment& segment, const Vector3f& x) const {
  const Stencil stencil = Look(x);
  std::array<float, 8> corners;
  Increase(segment, Scale(segment), stencil, &corners);
  return stencil.Value(corners);
}

}  // namespace mane::styling
