#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "rod/smooth_curve.h"

namespace mane::rod {

/// A frame whose first axis is along `tangent`, of unit length, and whose second is across it and
/// the world axis least along it.
[[nodiscard]] Eigen::Matrix3d FrameAlong(const Eigen::Vector3d& tangent);

/// `R` turned by the smallest rotation that brings its first axis along `tangent`, of unit length.
[[nodiscard]] Eigen::Matrix3d AlignedTo(const Eigen::Matrix3d& R, const Eigen::Vector3d& tangent);

/// Element angles that follow `curve` piece by piece from the root frame `R`, (N): each element by
/// itself from the curve's point and tangent at its left end (rod.md, F3).
///
/// @param fraction      where elements begin and end, in parts of the length, (N + 1), 0 to 1.
/// @param twist_weight  of a twist of 1 rad against squared distances in units of the element's
///                      length, summed over eight points of it.
[[nodiscard]] std::vector<Eigen::Vector3d> GuessAngles(const SmoothCurve& curve, Eigen::Matrix3d R,
                                                       std::span<const double> fraction,
                                                       double twist_weight);

}  // namespace mane::rod
