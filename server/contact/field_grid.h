#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace mane::contact {

/// A distance field as numbers: a grid of cubic root cells. One near the surface is divided into
/// 4^3 children, each cut into n^3 cells as finely as the surface asks for. Every corner of a cell
/// holds the distance and its gradient.
///
/// In a cell the distance is the mean over its corners of what they extrapolate with half their
/// gradient (D10): exact for quadratic fields, with an error of third order. The normal is the mean
/// of the corners' (D11). Both are continuous, also towards larger cells: corners on a face between
/// them carry what the larger cell says there, which makes the two agree on all of it.
///
/// Memory: 16 bytes a corner: one for a root cell, 125 for a divided one, (n + 1)^3 for a child
/// with n > 1; 8 bytes a cell and a child.
struct FieldGrid {
  /// Distance [m] and its gradient at a corner.
  struct alignas(16) Node {
    float d, gx, gy, gz;
  };

  /// A root cell or a child.
  struct Cell {
    uint32_t first = 0;     ///< Its first corner in `nodes`; its first child in `index` if divided.
    uint32_t n : 8 = 1;     ///< Cells along a side: 1, 2, 4, 8 or 16; 0 of a divided root cell.
    uint32_t row : 24 = 0;  ///< Corners from one to the next along y in `nodes`.
  };

  static constexpr int kChildren = 4;  ///< Along a side of a divided root cell.

  Eigen::Vector3d origin = Eigen::Vector3d::Zero();  ///< Lowest corner [m].
  double side = 0;                                   ///< Of a root cell [m].
  std::array<int, 3> cells{};                        ///< Root cells along x, y, z.
  std::vector<Cell> index;  ///< Root cells, x fastest; then the children of each divided one.
  std::vector<Node> nodes;  ///< Root corners, x fastest; then those of children.

  [[nodiscard]] int Roots() const { return cells[0] * cells[1] * cells[2]; }
  [[nodiscard]] size_t Root(int x, int y, int z) const {
    return (static_cast<size_t>(z) * cells[1] + y) * cells[0] + x;
  }
  [[nodiscard]] size_t RootNode(int x, int y, int z) const {
    return (static_cast<size_t>(z) * (cells[1] + 1) + y) * (cells[0] + 1) + x;
  }
  [[nodiscard]] size_t Bytes() const {
    return index.size() * sizeof(Cell) + nodes.size() * sizeof(Node);
  }
};

/// Where the corners of a block of cells lie in memory.
struct NodeBlock {
  const FieldGrid::Node* first;
  size_t row, layer;  ///< Corners from one to the next along y, z.
  int n;              ///< Cells along a side.
  float side;         ///< Of the block [m].
};

/// Distance and gradient of a point in a block; the gradient may be shorter than one.
struct FieldSample {
  float d, gx, gy, gz;
};

/// Asks memory for the corners that Interpolate will read.
[[gnu::always_inline]] inline void Prefetch(const NodeBlock& block, const float (&share)[3]) {
  size_t at[3];
  for (int a = 0; a < 3; ++a) {
    const int place = static_cast<int>(share[a] * static_cast<float>(block.n));
    at[a] = place < block.n ? place : block.n - 1;
  }
  const FieldGrid::Node* corner = block.first + at[2] * block.layer + at[1] * block.row + at[0];
  __builtin_prefetch(corner);
  __builtin_prefetch(corner + block.row);
  __builtin_prefetch(corner + block.layer);
  __builtin_prefetch(corner + block.layer + block.row);
}

/// (D10) and (D11) at a point of a block.
/// @param u,v,w  along x, y, z as shares of the block's side, in [0, 1].
[[gnu::always_inline]] inline FieldSample Interpolate(const NodeBlock& block, float u, float v,
                                                      float w) {
  typedef float Float4 __attribute__((vector_size(16)));
  const auto n = static_cast<float>(block.n);
  const float x = u * n, y = v * n, z = w * n;
  const int last = block.n - 1;
  const int i = static_cast<int>(x) < last ? static_cast<int>(x) : last;
  const int j = static_cast<int>(y) < last ? static_cast<int>(y) : last;
  const int k = static_cast<int>(z) < last ? static_cast<int>(z) : last;
  const float s = x - static_cast<float>(i);
  const float t = y - static_cast<float>(j);
  const float r = z - static_cast<float>(k);
  const FieldGrid::Node* corner = block.first + k * block.layer + j * block.row + i;
  const auto load = [corner](size_t offset) {
    Float4 value;
    __builtin_memcpy(&value, __builtin_assume_aligned(corner + offset, 16), sizeof value);
    return value;
  };
  // Along x: differences and means of (d, gradient) on the cell's four edges.
  const size_t row = block.row, layer = block.layer;
  const Float4 a00 = load(0), a10 = load(row), a01 = load(layer), a11 = load(layer + row);
  const Float4 d00 = load(1) - a00, d10 = load(row + 1) - a10;
  const Float4 d01 = load(layer + 1) - a01, d11 = load(layer + row + 1) - a11;
  const Float4 b00 = a00 + s * d00, b10 = a10 + s * d10, b01 = a01 + s * d01, b11 = a11 + s * d11;
  // Along y and z. dx, dy, dz are the mean differences along each axis.
  const Float4 e0 = b10 - b00, e1 = b11 - b01;
  const Float4 c0 = b00 + t * e0, c1 = b01 + t * e1;
  const Float4 dz = c1 - c0;
  const Float4 dy = e0 + r * (e1 - e0);
  const Float4 f0 = d00 + t * (d10 - d00), f1 = d01 + t * (d11 - d01);
  const Float4 dx = f0 + r * (f1 - f0);
  const Float4 mean = c0 + r * dz;
  const float half = 0.5F * block.side / n;
  const float bend = s * (1 - s) * dx[1] + t * (1 - t) * dy[2] + r * (1 - r) * dz[3];
  return {mean[0] - half * bend, mean[1], mean[2], mean[3]};
}

/// The block that holds a point of a root cell. `share` is the point's place in the root cell along
/// x, y, z, in [0, 1], and becomes its place in the block.
[[gnu::always_inline]] inline NodeBlock Locate(const FieldGrid& grid, size_t root,
                                               float (&share)[3]) {
  FieldGrid::Cell cell = grid.index[root];
  if (cell.n != 0) {
    return {grid.nodes.data() + cell.first, cell.row, size_t{cell.row} * (grid.cells[1] + 1),
            static_cast<int>(cell.n), static_cast<float>(grid.side)};
  }
  constexpr int kChildren = FieldGrid::kChildren;
  int child = 0;
  for (int i = 2; i >= 0; --i) {
    const float at = share[i] * kChildren;
    const int place = static_cast<int>(at) < kChildren ? static_cast<int>(at) : kChildren - 1;
    share[i] = at - static_cast<float>(place);
    child = child * kChildren + place;
  }
  cell = grid.index[cell.first + child];
  return {grid.nodes.data() + cell.first, cell.row, size_t{cell.row} * cell.row,
          static_cast<int>(cell.n), static_cast<float>(grid.side) / kChildren};
}

}  // namespace mane::contact
