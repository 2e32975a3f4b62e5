#include "contact/field_match.h"

namespace mane::contact {
namespace {

constexpr int kChildUnits = kUnits / FieldGrid::kChildren;

// Size of the cells, in units, on one side of a corner; 0 outside the grid.
// @param at  unit cell along x, y, z.
int StepAt(const FieldGrid& grid, const std::array<int, 3>& at) {
  size_t child = 0;
  for (int a = 2; a >= 0; --a) {
    if (at[a] < 0 || at[a] >= kUnits * grid.cells[a]) return 0;
    child = child * FieldGrid::kChildren + at[a] % kUnits / kChildUnits;
  }
  const FieldGrid::Cell& root =
      grid.index[grid.Root(at[0] / kUnits, at[1] / kUnits, at[2] / kUnits)];
  if (root.n != 0) return kUnits;
  return kChildUnits / static_cast<int>(grid.index[root.first + child].n);
}

// What the cell that holds the unit cell `at` says at the corner `corner` of it [units].
FieldGrid::Node Evaluate(const FieldGrid& grid, const std::array<int, 3>& at,
                         const std::array<int, 3>& corner) {
  const size_t root = grid.Root(at[0] / kUnits, at[1] / kUnits, at[2] / kUnits);
  // Located by the unit cell's middle, so that the right one of two neighbours is found.
  float middle[3], share[3];
  for (int a = 0; a < 3; ++a) {
    middle[a] = (static_cast<float>(at[a] % kUnits) + 0.5F) / kUnits;
    share[a] = middle[a];
  }
  const NodeBlock block = Locate(grid, root, share);
  const bool is_root = grid.index[root].n != 0;
  const float units = is_root ? kUnits : kChildUnits;
  for (int a = 0; a < 3; ++a) {
    share[a] += (static_cast<float>(corner[a] - at[a]) - 0.5F) / units;
  }
  const FieldSample s = Interpolate(block, share[0], share[1], share[2]);
  return {s.d, s.gx, s.gy, s.gz};
}

void MatchCorner(const std::array<int, 3>& corner, int step, FieldGrid* grid,
                 FieldGrid::Node* node) {
  int largest = step;
  std::array<int, 3> there{};
  for (int side = 0; side < 8; ++side) {
    const std::array<int, 3> at{corner[0] - (side & 1), corner[1] - (side >> 1 & 1),
                                corner[2] - (side >> 2)};
    const int other = StepAt(*grid, at);
    if (other <= largest) continue;
    largest = other;
    there = at;
  }
  if (largest > step) *node = Evaluate(*grid, there, corner);
}

// Matches the outer corners of a block of n^3 cells.
void MatchBlock(const std::array<int, 3>& low, int n, int step, FieldGrid* grid,
                FieldGrid::Node* first) {
  for (int k = 0; k <= n; ++k) {
    for (int j = 0; j <= n; ++j) {
      const bool within = k > 0 && k < n && j > 0 && j < n;
      for (int i = 0; i <= n; i += within ? n : 1) {
        MatchCorner({low[0] + i * step, low[1] + j * step, low[2] + k * step}, step, grid,
                    first + (k * (n + 1) + j) * (n + 1) + i);
      }
    }
  }
}

}  // namespace

void MatchRoot(const std::array<int, 3>& root, int step, FieldGrid* grid) {
  constexpr int n = FieldGrid::kChildren;
  const std::array<int, 3> low{root[0] * kUnits, root[1] * kUnits, root[2] * kUnits};
  const FieldGrid::Cell* children =
      grid->index.data() + grid->index[grid->Root(root[0], root[1], root[2])].first;
  if (step == kChildUnits) {
    // The corners of all children. Where one is not cut, they are its own.
    for (int child = 0; child < n * n * n; ++child) {
      if (children[child].n != 1) continue;
      const int i = child % n, j = child / n % n, k = child / n / n;
      for (int corner = 0; corner < 8; ++corner) {
        const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
        MatchCorner({low[0] + (i + x) * step, low[1] + (j + y) * step, low[2] + (k + z) * step},
                    step, grid,
                    grid->nodes.data() + children[child].first + (z * (n + 1) + y) * (n + 1) + x);
      }
    }
    return;
  }
  for (int child = 0; child < n * n * n; ++child) {
    const int cells = static_cast<int>(children[child].n);
    if (kChildUnits / cells != step) continue;
    const int i = child % n, j = child / n % n, k = child / n / n;
    MatchBlock({low[0] + i * kChildUnits, low[1] + j * kChildUnits, low[2] + k * kChildUnits},
               cells, step, grid, grid->nodes.data() + children[child].first);
  }
}

}  // namespace mane::contact
