#include "contact/segment_grid.h"

#include <cmath>

namespace mane::contact {
namespace {

constexpr float kCell = 0.6f;       // Side of a cell, by the largest box in its grid.
constexpr float kFirst = 1.25f;     // Largest box of the first grids, by the mean one.
constexpr float kSmallest = 1e-3f;  // Box that is told from smaller ones [m].
constexpr float kLong = 1.5f;       // A box is long along an axis that is so many others.
constexpr size_t kSamples = 100;    // Queries that tell how many tests they make.

float Size(const SegmentBox& box) { return (box.high - box.low).maxCoeff(); }

// 0 to 2 for the axis along which a box is long; 3 for none.
int Shape(const SegmentBox& box) {
  const Eigen::Array3f size = box.high - box.low;
  Eigen::Index axis;
  const float longest = size.maxCoeff(&axis);
  for (Eigen::Index k = 0; k < 3; ++k) {
    if (k != axis && kLong * size[k] > longest) return 3;
  }
  return static_cast<int>(axis);
}

// Bits of a grid of at least twice as many cells.
int BitsFor(size_t count) {
  int bits = 2;
  while (bits < 8 && (size_t{1} << 3 * bits) < 2 * count) ++bits;
  return bits;
}

}  // namespace

void SegmentGrid::Level::Start(size_t most) {
  start.reserve((size_t{1} << 3 * BitsFor(most)) + 1);
  if (count == 0) return;
  inverse_cell = 1 / (kCell * largest);
  bits = BitsFor(static_cast<size_t>(count));
  start.assign((size_t{1} << 3 * bits) + 1, 0);
}

double SegmentGrid::Level::Tests(std::span<const SegmentBox> of) const {
  if (count == 0) return 0;
  // As if all cells that have any had equally many.
  double used = 0, cells = 0, queries = 0;
  for (size_t c = 0; c + 1 < start.size(); ++c) used += start[c] < start[c + 1];
  for (size_t b = 0; b < of.size(); b += of.size() / kSamples + 1) {
    if (of[b].guide < 0) continue;
    const Cells around = CellsAround(of[b]);
    cells += (around.high - around.low + 1).cast<double>().prod();
    ++queries;
  }
  return cells / std::max(queries, 1.0) * (1 + count / used);
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
  for (Level& level : levels_) {
    level.count = 0;
    level.largest.setConstant(kSmallest);
  }
  level_of_.resize(boxes.size());
  for (size_t b = 0; b < boxes.size(); ++b) {
    level_of_[b] = -1;
    if (boxes[b].guide < 0) continue;
    const int size = std::clamp(std::ilogb(Size(boxes[b]) / first) + 1, 0, kSizes - 1);
    level_of_[b] = static_cast<int8_t>(size * kShapes + Shape(boxes[b]));
    Level& level = levels_[static_cast<uint8_t>(level_of_[b])];
    ++level.count;
    level.largest = level.largest.max(boxes[b].high - boxes[b].low);
  }

  // Counting sort; `start` holds ends until each box has moved its cell's one down.
  sorted_.resize(boxes.size());
  index_.resize(boxes.size());
  for (Level& level : levels_) level.Start(boxes.size());
  for (size_t b = 0; b < boxes.size(); ++b) {
    if (level_of_[b] < 0) continue;
    Level& level = levels_[static_cast<uint8_t>(level_of_[b])];
    ++level.start[level.CellOf(boxes[b])];
  }
  int32_t end = 0;
  for (Level& level : levels_) {
    if (level.count == 0) continue;
    for (int32_t& k : level.start) k = end += k;
  }
  for (size_t b = boxes.size(); b-- > 0;) {
    if (level_of_[b] < 0) continue;
    Level& level = levels_[static_cast<uint8_t>(level_of_[b])];
    const auto k = static_cast<size_t>(--level.start[level.CellOf(boxes[b])]);
    sorted_[k] = boxes[b];
    index_[k] = static_cast<int32_t>(b);
  }
  tests_ = 0;
  for (const Level& level : levels_) tests_ += level.Tests(boxes);
}

}  // namespace mane::contact
