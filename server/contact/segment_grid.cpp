#include "contact/segment_grid.h"

#include <algorithm>

namespace mane::contact {
namespace {

constexpr float kSmallestCell = 1e-3f;  // [m]
// A box that is much larger than most lies in at most this many cells along an axis, or one more.
constexpr float kMostCells = 6;

template <typename Visit>
void ForCells(const Eigen::Array3i& low, const Eigen::Array3i& high, const Visit& visit) {
  Eigen::Array3i cell;
  for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) {
    for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1]) {
      for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0]) visit(cell);
    }
  }
}

}  // namespace

void SegmentGrid::Build(std::span<const SegmentBox> boxes) {
  boxes_ = boxes;

  // Cells as large as the mean box.
  double sum = 0;
  float largest = kSmallestCell;
  size_t count = 0;
  for (const SegmentBox& box : boxes) {
    if (box.guide < 0) continue;
    const float size = (box.high - box.low).maxCoeff();
    sum += size;
    largest = std::max(largest, size);
    ++count;
  }
  const double mean = sum / static_cast<double>(std::max<size_t>(count, 1));
  inverse_cell_ = 1 / std::max({static_cast<float>(mean), largest / kMostCells, kSmallestCell});

  // About one bucket for every other entry.
  int bits = 4;
  while (bits < 24 && (size_t{1} << bits) < 2 * count) ++bits;
  shift_ = 32 - bits;
  start_.assign((size_t{1} << bits) + 1, 0);

  // Counting sort by bucket; start_ holds ends until each entry has moved its bucket's one down.
  for (const SegmentBox& box : boxes) {
    if (box.guide < 0) continue;
    const Cells cells = CellsOf(box);
    ForCells(cells.low, cells.high,
             [&](const Eigen::Array3i& cell) { ++start_[Bucket(Key(cell))]; });
  }
  tests_ = 0;
  int32_t entries = 0;
  for (int32_t& start : start_) {
    tests_ += static_cast<double>(start) * start;
    entries += start;
    start = entries;
  }
  entries_.resize(static_cast<size_t>(entries));
  for (size_t b = boxes.size(); b-- > 0;) {
    if (boxes[b].guide < 0) continue;
    const Cells cells = CellsOf(boxes[b]);
    ForCells(cells.low, cells.high, [&](const Eigen::Array3i& cell) {
      const uint32_t key = Key(cell);
      entries_[static_cast<size_t>(--start_[Bucket(key)])] = {key, static_cast<int32_t>(b)};
    });
  }
}

}  // namespace mane::contact
