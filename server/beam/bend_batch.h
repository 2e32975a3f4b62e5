#pragma once

#include <span>
#include <vector>

#include "beam/bend.h"
#include "beam/kernels.h"
#include "simd/rows.h"

namespace mane::beam {

/// Hairs of equal k bent by the kernels, a block of simd::kLanes at a time. Immutable; rows are the
/// caller's, so that any number of threads bend at once.
///
/// T is float where speed counts, double where tests compare with the reference (Bend).
template <typename T>
class BendBatch {
 public:
  using Row = simd::Row<T>;

  /// @param weights  (k), as of Bend.
  /// @param hull     that nodes keep out of.
  BendBatch(std::span<const double> weights, const BendField& field, const Hull& hull);
  BendBatch(const BendBatch&) = delete;
  BendBatch& operator=(const BendBatch&) = delete;

  [[nodiscard]] int segments() const { return static_cast<int>(weights_.size()); }
  [[nodiscard]] size_t hair_rows() const;
  [[nodiscard]] size_t node_rows() const { return 3 * (weights_.size() + 1); }

  /// Bends a block. No allocation.
  ///
  /// @param hairs  1 to simd::kLanes; lanes beyond are as the last.
  /// @param rows   for the hairs, (hair_rows).
  /// @param nodes  gets the nodes, from the hull's center [m], (node_rows).
  void Bend(const KernelTable<T>& kernels, std::span<const BendHair> hairs, std::span<Row> rows,
            std::span<Row> nodes) const;

 private:
  Hull hull_;
  std::vector<T> weights_;
  std::vector<T> planes_;
  std::vector<BendForce<T>> forces_;
  BendScene<T> scene_;
};

}  // namespace mane::beam
