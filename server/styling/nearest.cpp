#include "styling/nearest.h"

#include <algorithm>
#include <limits>

#include "base/check.h"

namespace mane::styling {
namespace {

constexpr int kLeaf = 8;  // Points that are looked at one by one.

}  // namespace

NearestPoint::NearestPoint(std::span<const Eigen::Vector3d> points) {
  MANE_CHECK(!points.empty());
  nodes_.reserve(points.size());
  for (const Eigen::Vector3d& point : points) {
    nodes_.push_back({point, static_cast<int>(nodes_.size()), 0});
  }
  Build(0, static_cast<int>(nodes_.size()));
}

void NearestPoint::Build(int begin, int end) {
  if (end - begin <= kLeaf) return;
  Eigen::Vector3d low = nodes_[begin].point, high = low;
  for (int i = begin; i < end; ++i) {
    low = low.cwiseMin(nodes_[i].point);
    high = high.cwiseMax(nodes_[i].point);
  }
  int axis = 0;
  (high - low).maxCoeff(&axis);
  const int middle = begin + (end - begin) / 2;
  std::nth_element(nodes_.begin() + begin, nodes_.begin() + middle, nodes_.begin() + end,
                   [axis](const Node& a, const Node& b) { return a.point[axis] < b.point[axis]; });
  nodes_[middle].axis = axis;
  Build(begin, middle);
  Build(middle + 1, end);
}

void NearestPoint::Search(int begin, int end, const Eigen::Vector3d& x, Best& best) const {
  const auto look_at = [&](const Node& node) {
    const double squared = (node.point - x).squaredNorm();
    if (squared > best.squared) return;
    if (squared == best.squared && node.index > best.index) return;
    best = {squared, node.index};
  };
  if (end - begin <= kLeaf) {
    for (int i = begin; i < end; ++i) look_at(nodes_[i]);
    return;
  }
  const int middle = begin + (end - begin) / 2;
  const Node& node = nodes_[middle];
  const double beyond = x[node.axis] - node.point[node.axis];
  const bool left_first = beyond < 0;
  Search(left_first ? begin : middle + 1, left_first ? middle : end, x, best);
  if (beyond * beyond > best.squared) return;
  look_at(node);
  Search(left_first ? middle + 1 : begin, left_first ? end : middle, x, best);
}

int NearestPoint::Find(const Eigen::Vector3d& x) const {
  Best best{std::numeric_limits<double>::infinity(), std::numeric_limits<int>::max()};
  Search(0, static_cast<int>(nodes_.size()), x, best);
  return best.index;
}

}  // namespace mane::styling
