#pragma once

#include <Eigen/Core>

#include <span>

#include "math/rigid.h"

namespace mane::wire {

/// Points of a Super-Helix from its generalized coordinates, in closed form.
///
/// An element of length l has constant material curvatures; theta = l kappa are its angles, twist
/// then the two bends [rad]. Along it, with phi = u theta for the part u in [0, 1] of its length,
///
///     R(u) = R (1 + c1 [phi] + c2 [phi]^2)              [SH06] (3), Rodrigues' formula
///     r(u) = r + u l R (1 + c2 [phi] + c3 [phi]^2) e0   its integral, e0 = (1, 0, 0)
///
/// where [phi] is the matrix of phi x and c_k = c_k(|phi|^2) are Stumpff's functions, which are
/// smooth at zero, so straight elements need no case of their own. The columns of R are n0 (the
/// tangent), n1, n2; the next element starts where this one ends.
///
/// Writes out.size() points at equal arc length: the first is the root, the last the tip.
///
/// @param root     clamped end: takes (n0, n1, n2) coordinates to the frame of the points.
/// @param lengths  element lengths, root to tip [m], (N), N >= 1, each positive.
/// @param theta    element angles [rad], (N).
/// @param out      (points), at least 2 [m].
///
/// Consecutive points are never farther apart than their arc length. Pure; no allocation;
/// O(N + points).
void SamplePoints(const math::Pose& root, std::span<const double> lengths,
                  std::span<const Eigen::Vector3d> theta, std::span<Eigen::Vector3d> out);

/// The same, rounded to float32 at the end.
void SamplePoints(const math::Pose& root, std::span<const double> lengths,
                  std::span<const Eigen::Vector3d> theta, std::span<Eigen::Vector3f> out);

}  // namespace mane::wire
