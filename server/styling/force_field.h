#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

#include "base/result.h"
#include "styling/style.h"

namespace mane::styling {

/// INVALID_ARGUMENT naming `<field>[2].grid.values` or so, unless there are at most 64 terms, their
/// numbers are finite, strengths lie within ±1000, centres within ±100 m, radii in [0, 100] m,
/// directions that are used have a length in [1e-6, 1e6], and a grid has 2 to 512 nodes along each
/// axis, cells in (0, 10] m, a value for every node, and is there where the term asks for one.
[[nodiscard]] Result<void> Validate(const std::vector<FieldTerm>& terms, const std::string& field);

/// Phi of [CK05] 3.1: the sum of its terms (D1) to (D3) of solver.md, evaluated where it is asked
/// for. [CK05] 3.3 stores it on the density's grid; a few terms are exact, need no memory and cost
/// less than a look at a grid of millions of nodes does (solver.md has numbers).
///
/// Immutable, thread-safe, no allocation. Refers to the terms' grids, which it keeps alive.
class ForceField {
 public:
  /// @param terms  valid. Directions need not be unit vectors: `strength` is the size.
  explicit ForceField(std::vector<FieldTerm> terms);

  /// Phi at a point of the head frame [m].
  [[nodiscard]] Eigen::Vector3d At(const Eigen::Vector3d& x) const;

  /// Phi at the nodes of a box, x fastest: what At says there.
  ///
  /// @param low    first node [m].
  /// @param cell   distance of nodes [m].
  /// @param nodes  along each axis, >= 0.
  [[nodiscard]] std::vector<Eigen::Vector3f> Sample(const Eigen::Vector3d& low, double cell,
                                                    const Eigen::Vector3i& nodes) const;

 private:
  std::vector<FieldTerm> terms_;  // With directions of length one.
};

}  // namespace mane::styling
