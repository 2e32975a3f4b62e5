#pragma once

#include <Eigen/Core>

#include <vector>

#include "math/rigid.h"
#include "rod/strand.h"

namespace mane::rod {

/// Which coarse element each fine one is a part of, root to tip, (N): 0, then the same or one more.
using Parts = std::vector<int>;

/// Replaces lengths, angles or rates of a fine strand by those of the coarse one: sums over parts.
template <typename Value>
void Merge(const Parts& parts, std::vector<Value>* values) {
  for (size_t Q = 1; Q < parts.size(); ++Q) {
    if (parts[Q] == parts[Q - 1]) {
      (*values)[parts[Q]] += (*values)[Q];
    } else {
      (*values)[parts[Q]] = (*values)[Q];
    }
  }
  values->resize(parts.back() + 1);
}

/// A strand with its rest shape.
struct RestingStrand {
  Strand strand;
  std::vector<Eigen::Vector3d> rest;  ///< Element angles [rad], (N).
};

/// Lowest scaled eigenvalue of the energy's Hessian (rod.md, I3) that a merged strand must have: 1
/// is a strand without weight, 0 the brink of buckling, near which a little less detail is enough
/// to come to rest elsewhere.
inline constexpr double kCoarseMargin = 0.2;

/// `fine` with its elements merged, at rest in the merged rest shape: natural curvatures
/// are those that make it an equilibrium (rod.md, I1, D1).
///
/// @param clamp    root frame; only its rotation matters.
/// @param gravity  [m/s^2], in the frame of `clamp`'s parent.
/// @param stable   whether that equilibrium is a minimum by kCoarseMargin.
[[nodiscard]] RestingStrand Coarsen(const RestingStrand& fine, const Parts& parts,
                                    const math::Pose& clamp, const Eigen::Vector3d& gravity,
                                    bool* stable);

}  // namespace mane::rod
