#pragma once

#include <Eigen/Core>

#include "rod/strand.h"

namespace mane::rod {

/// One element of a wound strand: a Super-Helix element along the AXIS of a natural coil, with the
/// coil put around it. For hair that winds more often than its elements can follow; formulas C1 to
/// C10 of coil.md. Unknowns of an element are x = l (u, b1, b2, xi) [rad]: changes of the hair's
/// own strain along the coil's axis (u) and towards its tangent (xi), which twist and stretch the
/// coil, and the curvature of the axis (b1, b2). Lengths are in units of the element's arc length,
/// and frames are axis frames A, whose first axis is the coil's. Pure, no allocation.

using Vector4d = Eigen::Matrix<double, 4, 1>;
using Matrix34d = Eigen::Matrix<double, 3, 4>;

/// A natural helix seen from its axis (C1), and its stiffness as a rod of its own (C6).
struct Coil {
  Eigen::Matrix3d F = Eigen::Matrix3d::Identity();  ///< Columns axis, w, axis x w in (n0, n1, n2).
  double winding = 0;                               ///< omega, turn about the axis [rad/m].
  double rise = 0;                                  ///< cos(alpha), axis length per arc length.
  double slant = 0;                                 ///< sin(alpha).
  double radius = 0;                                ///< sin(alpha) / omega [m].
  Eigen::Matrix4d stiffness = Eigen::Matrix4d::Zero();  ///< Of (u, b1, b2, xi) [N m^2].
};

/// The coil of natural (twist, curvature 1, curvature 2) [rad/m] and of stiffness (EI)_i [N m^2].
/// Needs a curvature other than 0: neither straight hair nor a pure twist has a coil.
[[nodiscard]] Coil MakeCoil(const Eigen::Vector3d& natural, const Eigen::Vector3d& stiffness);

/// What the unknowns of an element do to its axis (C3), and the derivatives by x.
struct CoilAxis {
  Eigen::Vector3d beta;  ///< Angles of the axis as a Super-Helix element: twist and bends [rad].
  double stretch = 0;    ///< lambda in [-1, 1]: axis length per arc length.
  Matrix34d dbeta;       ///< dbeta/dx
  Vector4d dstretch;     ///< dlambda/dx
  double slant = 0;      ///< Other part of the tangent: lambda^2 + slant^2 = 1.
  double winding = 0;    ///< omega l of the natural coil [rad].
};

/// Evaluates (C3). @param length  arc length l of the element [m].
[[nodiscard]] CoilAxis AxisOfElement(const Coil& coil, double length, const Vector4d& x);

/// Point, frame and rates at a fraction of an element: dx moves it by J dx, turns it by T dx.
struct CoilPoint {
  Eigen::Matrix3d E;  ///< Axis frame in the element's left one.
  Eigen::Vector3d p;
  Matrix34d J;  ///< dp/dx
  Matrix34d T;
};

/// Evaluates (C4), (C5) at `s` in [0, 1], for the point that sits at `offset` from the axis in the
/// axis frame there, such as a bead of (C7). [element lengths]
[[nodiscard]] CoilPoint PointOnCoil(const CoilAxis& axis, double s, const Eigen::Vector3d& offset);

/// What the far end passes on (C4, C5), and the centre of mass (C8): the axis's, as a whole coil is
/// balanced about it. As helix.h's ElementEnd.
struct CoilEnd {
  Eigen::Matrix3d E;
  Matrix34d T;
  Eigen::Vector3d p;
  Matrix34d J;  ///< dp/dx
  Eigen::Vector3d c;
  Matrix34d G;  ///< dc/dx
};
[[nodiscard]] CoilEnd EndOfCoil(const CoilAxis& axis);

/// Beads that carry the inertia (C7): offset of Gauss point `g` from the axis [m].
[[nodiscard]] Eigen::Vector3d BeadOffset(const Coil& coil, int g);

/// The hair itself (C9), where `phase` is the angle wound from the root, omega times arc length
/// [rad]: the vector y from the axis, such that p + E y less its value at the left end is exactly
/// as long as the hair. In the axis frame at that phase. [element lengths]
[[nodiscard]] Eigen::Vector3d CoilOffset(const CoilAxis& axis, double phase);

/// The hair from the element's left end, of that `phase`, to the fraction `s`: p + E y - y_left
/// (C9), in the left axis frame, also where the axis turns as fast as the coil. [element lengths]
[[nodiscard]] Eigen::Vector3d HairOnCoil(const CoilAxis& axis, double phase, double s);

/// Tangent of the hair in the axis frame (C9).
[[nodiscard]] Eigen::Vector3d CoilTangent(const CoilAxis& axis, double phase);

}  // namespace mane::rod
