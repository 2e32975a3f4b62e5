#include "contact/field_block.h"

#include <cmath>

namespace mane::contact {
namespace {

using Eigen::Vector3d;

// Corners count as connected only where their balls overlap by more than rounding.
constexpr double kOverlap = 1 + 1e-6;

}  // namespace

FieldBlock::FieldBlock(const SolidDistance& truth, const Vector3d& origin, double step,
                       const std::array<int, 3>& begin, const std::array<int, 3>& counts)
    : truth_(&truth), origin_(origin), step_(step), begin_(begin), counts_(counts) {
  const size_t size = static_cast<size_t>(counts[0]) * counts[1] * counts[2];
  distance_.resize(size);
  nearest_.resize(size);
  triangle_.resize(size);
  sign_.resize(size);
  nodes_.resize(size);
}

void FieldBlock::Measure(int i, int j, int k, double bound) {
  const size_t corner = At(i, j, k);
  const auto hit = truth_->Closest(Position(i, j, k), bound);
  distance_[corner] = hit.distance;
  nearest_[corner] = hit.point;
  triangle_[corner] = hit.triangle;
}

void FieldBlock::Adopt(int i, int j, int k, const FieldGrid::Node& node, double distance) {
  const size_t corner = At(i, j, k);
  distance_[corner] = distance;
  nodes_[corner] = node;
  sign_[corner] = node.d < 0 ? -1 : 1;
  waiting_.push_back(corner);
}

std::array<int, 3> FieldBlock::PlaceOf(size_t corner) const {
  const size_t row = corner / counts_[0];
  return {static_cast<int>(corner % counts_[0]), static_cast<int>(row % counts_[1]),
          static_cast<int>(row / counts_[1])};
}

void FieldBlock::SetNode(size_t corner, bool inside) {
  sign_[corner] = inside ? -1 : 1;
  const auto [i, j, k] = PlaceOf(corner);
  const double distance = distance_[corner];
  const Vector3d g =
      truth_->Normal(Position(i, j, k), {distance, nearest_[corner], triangle_[corner]}, inside);
  nodes_[corner] = {static_cast<float>(inside ? -distance : distance), static_cast<float>(g.x()),
                    static_cast<float>(g.y()), static_cast<float>(g.z())};
}

void FieldBlock::Spread(size_t from) {
  const size_t strides[3] = {1, static_cast<size_t>(counts_[0]),
                             static_cast<size_t>(counts_[0]) * counts_[1]};
  const bool inside = sign_[from] < 0;
  const std::array<int, 3> place = PlaceOf(from);
  for (int axis = 0; axis < 3; ++axis) {
    for (const int way : {-1, 1}) {
      const int there = place[axis] + way;
      if (there < 0 || there >= counts_[axis]) continue;
      const size_t to = way < 0 ? from - strides[axis] : from + strides[axis];
      if (sign_[to] != 0 || distance_[from] + distance_[to] <= kOverlap * step_) continue;
      SetNode(to, inside);
      waiting_.push_back(to);
    }
  }
}

void FieldBlock::Sign() {
  for (size_t corner = 0;; ++corner) {
    while (!waiting_.empty()) {
      const size_t from = waiting_.back();
      waiting_.pop_back();
      Spread(from);
    }
    while (corner < sign_.size() && sign_[corner] != 0) ++corner;
    if (corner == sign_.size()) return;
    const auto [i, j, k] = PlaceOf(corner);
    SetNode(corner, truth_->Inside(Position(i, j, k)));
    waiting_.push_back(corner);
  }
}

FieldBlock FieldBlock::Halved() const {
  FieldBlock fine(*truth_, origin_, step_ / 2, {2 * begin_[0], 2 * begin_[1], 2 * begin_[2]},
                  {2 * counts_[0] - 1, 2 * counts_[1] - 1, 2 * counts_[2] - 1});
  for (int k = 0; k < fine.counts_[2]; ++k) {
    for (int j = 0; j < fine.counts_[1]; ++j) {
      for (int i = 0; i < fine.counts_[0]; ++i) {
        const size_t near = At(i / 2, j / 2, k / 2);
        const int ways = i % 2 + j % 2 + k % 2;
        if (ways == 0) {
          fine.Adopt(i, j, k, nodes_[near], distance_[near]);
        } else {  // Distances change by no more than the way.
          fine.Measure(i, j, k, distance_[near] + fine.step_ * std::sqrt(ways));
        }
      }
    }
  }
  fine.Sign();
  return fine;
}

FieldBlock FieldBlock::Child(int i, int j, int k) const {
  FieldBlock child(*truth_, origin_, step_, {begin_[0] + i, begin_[1] + j, begin_[2] + k},
                   {2, 2, 2});
  for (int corner = 0; corner < 8; ++corner) {
    const int x = corner & 1, y = corner >> 1 & 1, z = corner >> 2;
    const size_t own = At(i + x, j + y, k + z);
    child.Adopt(x, y, z, nodes_[own], distance_[own]);
  }
  return child;
}

}  // namespace mane::contact
