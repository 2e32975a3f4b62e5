#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mane::contact {

/// An axis-aligned box around what a segment of a guide may meet in a step.
struct SegmentBox {
  Eigen::Array3f low, high;  ///< [m]
  int32_t guide = -1;        ///< -1: no segment.

  [[nodiscard]] bool Overlaps(const SegmentBox& other) const {
    int apart = 0;  // Without branches.
    for (int i = 0; i < 3; ++i) {
      apart |= static_cast<int>(low[i] > other.high[i]) | static_cast<int>(other.low[i] > high[i]);
    }
    return apart == 0;
  }
};

/// Finds boxes of different guides that overlap, by the cells that their middles lie in: uniform
/// grids, each for boxes of about one size and one shape, whose cells have it, too; hair that hangs
/// has boxes which are long in one direction. Space repeats itself after as many cells as a grid
/// has, which costs tests far from the middle of the hair, and no answer.
///
/// Build is linear in the boxes and serial; queries are const and thread-safe. Memory is kept: no
/// allocation once it has seen as many. The same boxes give the same order of answers always.
class SegmentGrid {
 public:
  /// @param boxes  by guide; looked at until the next Build.
  void Build(std::span<const SegmentBox> boxes);

  /// Calls visit(b) once for each box b that overlaps box a and belongs to another guide.
  template <typename Visit>
  void ForOverlapping(int a, const Visit& visit) const {
    const SegmentBox& box = boxes_[static_cast<size_t>(a)];
    if (box.guide < 0) return;
    for (const Level& level : levels_) {
      if (level.count == 0) continue;
      const Cells cells = level.CellsAround(box);
      const int mask = level.mask();
      for (int z = cells.low[2]; z <= cells.high[2]; ++z) {
        for (int y = cells.low[1]; y <= cells.high[1]; ++y) {
          // A row of cells is a stretch of boxes, or two where it goes round.
          const int low = cells.low[0] & mask, high = cells.high[0] & mask;
          if (low <= high) {
            VisitRow(level, level.Index(low, y, z), level.Index(high, y, z), box, visit);
          } else {
            VisitRow(level, level.Index(0, y, z), level.Index(high, y, z), box, visit);
            VisitRow(level, level.Index(low, y, z), level.Index(mask, y, z), box, visit);
          }
        }
      }
    }
  }

  /// About as many tests as a query makes, by some of the boxes.
  [[nodiscard]] double tests() const { return tests_; }

 private:
  static constexpr int kShapes = 4;  // Long along x, y or z; or along none.
  static constexpr int kSizes = 3;   // Of about the mean size, twice, four times as large or more.
  static constexpr int kLevels = kShapes * kSizes;

  struct Cells {
    Eigen::Array3i low, high;
  };
  // A grid of 2^(3 bits) cells.
  struct Level {
    Eigen::Array3f inverse_cell, largest;  // Along each axis; of a box in it [m].
    int bits = 1;
    int32_t count = 0;
    std::vector<int32_t> start;  // Of each cell's boxes among all that are sorted, and their end.

    [[nodiscard]] int mask() const { return (1 << bits) - 1; }

    [[nodiscard]] size_t Index(int x, int y, int z) const {
      return static_cast<size_t>(((z & mask()) << bits | (y & mask())) << bits | (x & mask()));
    }
    [[nodiscard]] size_t CellOf(const SegmentBox& box) const {
      const Eigen::Array3i cell = (0.5f * (box.low + box.high) * inverse_cell).floor().cast<int>();
      return Index(cell[0], cell[1], cell[2]);
    }
    // Those with the middles of boxes that may overlap `box`.
    [[nodiscard]] Cells CellsAround(const SegmentBox& box) const {
      const Cells cells{((box.low - 0.5f * largest) * inverse_cell).floor().cast<int>(),
                        ((box.high + 0.5f * largest) * inverse_cell).floor().cast<int>()};
      return {cells.low, cells.high.min(cells.low + mask())};
    }
    // Chooses the cells, all empty, for `count` boxes up to `largest`; may count `most` ones later
    // and not allocate.
    void Start(size_t most);
    // About as many tests as a query makes.
    [[nodiscard]] double Tests(std::span<const SegmentBox> of) const;
  };

  // Those of the cells [first, last].
  template <typename Visit>
  void VisitRow(const Level& level, size_t first, size_t last, const SegmentBox& box,
                const Visit& visit) const {
    const auto end = static_cast<size_t>(level.start[last + 1]);
    for (auto k = static_cast<size_t>(level.start[first]); k < end; ++k) {
      const SegmentBox& other = sorted_[k];
      if (box.Overlaps(other) && other.guide != box.guide) visit(index_[k]);
    }
  }

  std::span<const SegmentBox> boxes_;
  std::array<Level, kLevels> levels_;
  std::vector<SegmentBox> sorted_;  // By level and cell, of a cell in their order,
  std::vector<int32_t> index_;      // and which of all they are.
  std::vector<int8_t> level_of_;    // By box; -1 for none.
  double tests_ = 0;
};

}  // namespace mane::contact
