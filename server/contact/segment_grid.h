#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace mane::contact {

/// An axis-aligned box around what a segment of a guide may meet in a step.
struct SegmentBox {
  Eigen::Array3f low, high;  ///< [m]
  int32_t guide = -1;        ///< -1: no segment.

  [[nodiscard]] bool Overlaps(const SegmentBox& other) const {
    return (low <= other.high).all() && (other.low <= high).all();
  }
};

/// Finds boxes of different guides that overlap, by cells of a hashed uniform grid.
///
/// Build is linear in the boxes and serial; queries are const and thread-safe. Memory is kept: no
/// allocation once it has seen as many. The same boxes give the same order of answers always.
class SegmentGrid {
 public:
  /// @param boxes  looked at until the next Build. Cells are about as large as a box.
  void Build(std::span<const SegmentBox> boxes);

  /// Calls visit(b) once for each box b that overlaps box a and belongs to a later guide.
  template <typename Visit>
  void ForOverlapping(int a, const Visit& visit) const {
    const SegmentBox& box = boxes_[static_cast<size_t>(a)];
    if (box.guide < 0) return;
    const Cells cells = CellsOf(box);
    Eigen::Array3i cell;
    for (cell[2] = cells.low[2]; cell[2] <= cells.high[2]; ++cell[2]) {
      for (cell[1] = cells.low[1]; cell[1] <= cells.high[1]; ++cell[1]) {
        for (cell[0] = cells.low[0]; cell[0] <= cells.high[0]; ++cell[0]) {
          VisitCell(a, cells.low, cell, visit);
        }
      }
    }
  }

  /// Tests that the queries of all boxes will make.
  [[nodiscard]] double tests() const { return tests_; }

 private:
  struct Cells {
    Eigen::Array3i low, high;
  };
  struct Entry {
    uint32_t key;
    int32_t box;
  };

  [[nodiscard]] Cells CellsOf(const SegmentBox& box) const {
    return {(box.low * inverse_cell_).floor().cast<int>(),
            (box.high * inverse_cell_).floor().cast<int>()};
  }
  // Cells 1024 apart share a key, which costs tests and no answer.
  static uint32_t Key(const Eigen::Array3i& cell) {
    const auto part = [&](int i) { return static_cast<uint32_t>(cell[i]) & 1023u; };
    return part(0) | part(1) << 10 | part(2) << 20;
  }
  [[nodiscard]] size_t Bucket(uint32_t key) const { return (key * 2654435761u) >> shift_; }

  // Two boxes may share several cells; they meet in the lowest of them.
  template <typename Visit>
  void VisitCell(int a, const Eigen::Array3i& low, const Eigen::Array3i& cell,
                 const Visit& visit) const {
    const SegmentBox& box = boxes_[static_cast<size_t>(a)];
    const uint32_t key = Key(cell);
    const size_t bucket = Bucket(key);
    for (int32_t k = start_[bucket]; k < start_[bucket + 1]; ++k) {
      const Entry& entry = entries_[static_cast<size_t>(k)];
      const SegmentBox& other = boxes_[static_cast<size_t>(entry.box)];
      if (entry.key != key || other.guide <= box.guide || !box.Overlaps(other)) continue;
      const Eigen::Array3i lowest = low.max((other.low * inverse_cell_).floor().cast<int>());
      if ((lowest == cell).all()) visit(entry.box);
    }
  }

  std::span<const SegmentBox> boxes_;
  float inverse_cell_ = 1;
  int shift_ = 31;
  double tests_ = 0;
  std::vector<int32_t> start_;  // By bucket, and their number.
  std::vector<Entry> entries_;  // Of a bucket in the order of boxes.
};

}  // namespace mane::contact
