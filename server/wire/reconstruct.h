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

/// Points of a wound strand from its generalized coordinates, in closed form: the Super-Helix is
/// the axis of a coil, and the hair winds about it (server/rod/coil.md, C1 to C4, C9).
///
/// An element of length l has the coil of its natural strain kappa^n: it winds by W = omega l,
/// omega = |kappa^n|, and its tangent stands at alpha to the axis, cos(alpha) = kappa^n_0 / omega.
/// Its unknowns x = l (u, b1, b2, xi) give the angles beta of the axis, its length lambda and the
/// tangent's part across it, slant, by (C3). With the axis frame A, the phase phi wound from the
/// root and the part s in [0, 1],
///
///     r(s) = r + s l A (lambda chord(s beta) + slant Re w(s))
///     s w(s) = int_0^s exp(sigma [beta]) (0, 1, -i) e^(i (phi + W sigma)) dsigma
///
/// chord is the one of SamplePoints. The axis bends in three turnings, of rates 0 and +-|beta|,
/// so that the hair off it turns by W and W +- |beta|, and the integral of each, e^(i k s / 2)
/// sinc(k s / 2), is smooth at any rate k: neither a straight axis nor one that turns as fast as
/// the coil needs a case of its own.
///
/// Writes out.size() points at equal arc length of the hair: the first is the root, the last the
/// tip.
///
/// @param root     clamped end: takes (n0, n1, n2) coordinates to the frame of the points.
/// @param lengths  arc lengths of the elements, root to tip [m], (N), N >= 1, each positive.
/// @param natural  natural twist and curvatures 1 and 2 of each element [rad/m], (N), with a
///                 curvature other than 0.
/// @param x        unknowns l (u, b1, b2, xi) of each element [rad], (N).
/// @param out      (points), at least 2 [m].
///
/// Consecutive points are never farther apart than their arc length. Pure; no allocation;
/// O(N + points).
void SampleWoundPoints(const math::Pose& root, std::span<const double> lengths,
                       std::span<const Eigen::Vector3d> natural, std::span<const Eigen::Vector4d> x,
                       std::span<Eigen::Vector3d> out);

/// The same, rounded to float32 at the end.
void SampleWoundPoints(const math::Pose& root, std::span<const double> lengths,
                       std::span<const Eigen::Vector3d> natural, std::span<const Eigen::Vector4d> x,
                       std::span<Eigen::Vector3f> out);

}  // namespace mane::wire
