#include "contact/segment_grid.h"

#include <cmath>

namespace mane::contact {
namespace {

constexpr float kCell = 0.6f;       // Side of a cell, by the largest box in its grid.
constexpr float kFirst = 1.25f;     // Largest box of the first grid, by the mean one.
constexpr float kSmallest = 1e-3f;  // Box that is told from smaller ones [m].

float Size(const SegmentBox& box) { return (box.high - box.low).maxCoeff(); }

}  // namespace

void SegmentGrid::Level::Fill(std::span<const SegmentBox> all, std::span<const int8_t> level_of,
                              int level) {
  size_t count = 0;
  largest = kSmallest;
  for (size_t b = 0; b < all.size(); ++b) {
    if (level_of[b] != level) continue;
    ++count;
    largest = std::max(largest, Size(all[b]));
  }
  boxes.resize(count);
  index.resize(count);
  if (count == 0) return;
  inverse_cell = 1 / (kCell * largest);
  for (bits = 2; bits < 8 && (size_t{1} << 3 * bits) < 2 * count; ++bits) {
  }

  // Counting sort; `start` holds ends until each box has moved its cell's one down.
  const auto cell_of = [&](const SegmentBox& box) {
    const Eigen::Array3i cell = (0.5f * (box.low + box.high) * inverse_cell).floor().cast<int>();
    return Index(cell[0], cell[1], cell[2]);
  };
  start.assign((size_t{1} << 3 * bits) + 1, 0);
  for (size_t b = 0; b < all.size(); ++b) {
    if (level_of[b] == level) ++start[cell_of(all[b])];
  }
  int32_t sum = 0;
  for (int32_t& k : start) k = sum += k;
  for (size_t b = all.size(); b-- > 0;) {
    if (level_of[b] != level) continue;
    const auto k = static_cast<size_t>(--start[cell_of(all[b])]);
    boxes[k] = all[b];
    index[k] = static_cast<int32_t>(b);
  }
}

void SegmentGrid::Build(std::span<const SegmentBox> boxes) {
  boxes_ = boxes;
  double sum = 0, count = 0;
  for (const SegmentBox& box : boxes) {
    if (box.guide < 0) continue;
    sum += Size(box);
    ++count;
  }
  const float first = std::max(kFirst * static_cast<float>(sum / std::max(count, 1.0)), kSmallest);
  level_of_.resize(boxes.size());
  for (size_t b = 0; b < boxes.size(); ++b) {
    if (boxes[b].guide < 0) {
      level_of_[b] = -1;
      continue;
    }
    const int above = std::ilogb(Size(boxes[b]) / first) + 1;
    level_of_[b] = static_cast<int8_t>(std::clamp<int>(above, 0, kLevels - 1));
  }
  for (size_t k = 0; k < kLevels; ++k) levels_[k].Fill(boxes, level_of_, static_cast<int>(k));

  // Cells to be looked at, and their boxes as if all cells that have any had equally many.
  tests_ = 0;
  for (const Level& level : levels_) {
    if (level.boxes.empty()) continue;
    double used = 0;
    for (size_t c = 0; c + 1 < level.start.size(); ++c) used += level.start[c] < level.start[c + 1];
    const double each = 1 + static_cast<double>(level.boxes.size()) / used;
    for (size_t b = 0; b < boxes.size(); ++b) {
      if (level_of_[b] < 0) continue;
      const Cells cells = level.CellsAround(boxes[b]);
      tests_ += each * (cells.high - cells.low + 1).cast<double>().prod();
    }
  }
}

}  // namespace mane::contact
