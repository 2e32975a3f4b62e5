#pragma once

#include <cstdint>
#include <vector>

#include "contact/field_grid.h"
#include "contact/solid_distance.h"

namespace mane::contact {

/// Exact distances at the corners of a block of equal cubic cells, with their signs.
///
/// Signs cost one winding number per connected set of corners: two corners a step s apart lie on
/// one side of the surface where their distances sum up to more than s (D9).
class FieldBlock {
 public:
  /// @param origin  lowest corner of the whole lattice [m]; corner (i, j, k) of this block lies at
  ///   origin + step * (begin + (i, j, k)), the same number whichever block asks.
  /// @param counts  corners along each axis, >= 2.
  FieldBlock(const SolidDistance& truth, const Eigen::Vector3d& origin, double step,
             const std::array<int, 3>& begin, const std::array<int, 3>& counts);

  [[nodiscard]] size_t size() const { return nodes_.size(); }
  [[nodiscard]] size_t At(int i, int j, int k) const {
    return (static_cast<size_t>(k) * counts_[1] + j) * counts_[0] + i;
  }
  [[nodiscard]] std::array<int, 3> PlaceOf(size_t corner) const;
  [[nodiscard]] Eigen::Vector3d Position(int i, int j, int k) const {
    return origin_ + step_ * Eigen::Vector3d(begin_[0] + i, begin_[1] + j, begin_[2] + k);
  }

  /// Finds the nearest surface point of one corner, known to lie within `bound` [m].
  void Measure(int i, int j, int k, double bound);
  /// Takes over a corner that another block has measured and signed.
  void Adopt(int i, int j, int k, const FieldGrid::Node& node, double distance);
  /// Signs all corners, each of which was measured or adopted.
  void Sign();
  /// The same block in cells of half the side, measured and signed.
  [[nodiscard]] FieldBlock Halved() const;
  /// One of its cells.
  [[nodiscard]] FieldBlock Child(int i, int j, int k) const;

  /// Between neighbours [m].
  [[nodiscard]] double step() const { return step_; }
  [[nodiscard]] const std::array<int, 3>& counts() const { return counts_; }
  /// Unsigned [m].
  [[nodiscard]] double distance(size_t corner) const { return distance_[corner]; }
  /// Signed, once Sign was called.
  [[nodiscard]] const std::vector<FieldGrid::Node>& nodes() const { return nodes_; }

 private:
  void Spread(size_t from);
  void SetNode(size_t corner, bool inside);

  const SolidDistance* truth_;
  Eigen::Vector3d origin_;
  double step_;
  std::array<int, 3> begin_, counts_;
  std::vector<double> distance_;
  std::vector<Eigen::Vector3d> nearest_;
  std::vector<int> triangle_;
  std::vector<int8_t> sign_;  // 0 while unknown.
  std::vector<FieldGrid::Node> nodes_;
  std::vector<size_t> waiting_;
};

}  // namespace mane::contact
