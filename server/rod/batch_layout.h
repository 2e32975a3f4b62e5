#pragma once

#include "rod/scheme.h"
#include "simd/rows.h"

/// Rows of a block of strands for the batched kernels (simd/rows.h). All strands of a block have
/// the same number of elements. Lengths are in units of the strand's mean element length l0 = L / N
/// and masses in rho S l0, which keeps float32 in range; times in seconds, angles in radians
/// (rod.md, Batch).
namespace mane::rod::layout {

using simd::kLanes;

/// Rows of a block's constants.
enum Constant : int {
  kRootFrame = 0,                      ///< Columns n0, n1, n2 of the root frame in the head's (9).
  kRootPosition = kRootFrame + 9,      ///< Root in the head's frame [m] (3).
  kUnit = kRootPosition + 3,           ///< l0 [m].
  kInverseUnit,                        ///< 1 / l0 [1/m].
  kDrag,                               ///< nu / (rho S) [1/s].
  kFriction,                           ///< gamma / (rho S l0^4) [1/s].
  kStiffness,                          ///< (EI)_i / (rho S l0^4) [1/s^2] (3).
  kRotaryInertia = kStiffness + 3,     ///< mu of plain strands (S12).
  kUnitMass,                           ///< rho S l0 [kg].
  kFirstElement,                       ///< Then each element:
  kLength = 0,                         ///< l_Q / l0.
  kInverseLength,                      ///< l0 / l_Q.
  kNatural,                            ///< Natural angles [rad] (3).
  kConstantsPerElement = kNatural + 3  ///< Rows of an element.
};

/// Rows of an element's state; a block's state is N of them.
enum State : int {
  kAngles = 0,               ///< theta [rad] (3).
  kRates = kAngles + 3,      ///< d theta/dt over the last step [rad/s] (3).
  kVelocities = kRates + 3,  ///< At the Gauss points, world [l0/s] (kGaussPoints x 3).
  kStatePerElement = kVelocities + 3 * kGaussPoints  ///< Rows of an element.
};

/// Rows of a wound element's constants (coil.md), in the place of a plain one's.
enum WoundConstant : int {
  kWinding = kNatural,  ///< W, turn of the natural coil [rad].
  kRise,                ///< cos(alpha)
  kSlant,               ///< sin(alpha)
  kRadius,              ///< Of the coil / l0.
  kTwisting,            ///< K of (u, u), of the bends, of (xi, xi) and of (u, xi), over
  kBending,             ///< rho S l0^4 [1/s^2].
  kStretching,          ///< .
  kCoupling,            ///< .
  kNaturalUnknowns,     ///< x^n [rad] (4).
  kPhaseCosine = kNaturalUnknowns + 4,  ///< Of the phase of the left end,
  kPhaseSine,                           ///< .
  kConstantsPerWoundElement             ///< Rows of an element.
};

/// Rows of a wound element's state.
enum WoundState : int {
  kUnknowns = 0,                        ///< x = l (u, b1, b2, xi) [rad] (4).
  kUnknownRates = kUnknowns + 4,        ///< dx/dt over the last step [rad/s] (4).
  kBeadVelocities = kUnknownRates + 4,  ///< Of the beads, world [l0/s] (kBeads x 3).
  kStatePerWoundElement = kBeadVelocities + 3 * kBeads  ///< Rows of an element.
};

/// Rows of what drives a step, lane by lane, so that strands of different heads may share a block.
enum Drive : int {
  kMiddleFrame = 0,             ///< Head's rotation at kTheta of the way, columns (9).
  kSpread = kMiddleFrame + 9,   ///< Change of the head's rotation matrix over dt [1/s] (9).
  kHeadVelocity = kSpread + 9,  ///< Head's displacement over dt [m/s] (3).
  kSpin = kHeadVelocity + 3,    ///< Head's turn over dt, world [rad/s] (3).
  kGravity = kSpin + 3,         ///< World [m/s^2] (3).
  kWind = kGravity + 3,         ///< Air velocity, world [m/s] (3).
  kDuration = kWind + 3,        ///< dt [s].
  kFrictionScale,               ///< Factor on internal friction.
  kDragScale,                   ///< Factor on air drag.
  kDriveRows                    ///< Rows in all.
};

/// Rows of the pose under which positions are asked for, lane by lane.
enum Pose : int {
  kPoseFrame = 0,                  ///< Head's rotation, columns (9).
  kPosePosition = kPoseFrame + 9,  ///< Head's position [m] (3).
  kPoseRows = kPosePosition + 3    ///< Rows in all.
};

/// Rows of a point of the strands where they are linearised (rod.md, S2); of wound ones, of a point
/// of the axis.
enum Point : int {
  kPosition = 0,                  ///< From the head's place at kTheta of the way, world [m] (3).
  kTangent = kPosition + 3,       ///< Root to tip, world (3).
  kLastVelocity = kTangent + 3,   ///< That led here, world [m/s] (3).
  kPointRows = kLastVelocity + 3  ///< Rows in all.
};

/// Rows of what presses and rubs at a point (rod.md, S13): W = hold (1 - n n^T) + press n n^T.
/// Masses in rho S l0.
enum Load : int {
  kNormal = 0,           ///< n, world (3).
  kPress = kNormal + 3,  ///< Along n; >= 0.
  kHold,                 ///< Across n; >= 0.
  kPush,                 ///< p [m/s] (3).
  kImpulse = kPush + 3,  ///< What others add to p [m/s] (3).
  kSurfaceSpeed =
      kImpulse + 3,  ///< Along n, which no element leaves faster where press > 0 (S14) [m/s].
  kLoadRows          ///< Rows in all.
};

/// Kinds of strand that a block holds; all of one kind.
enum class Kind { kPlain, kWound };

/// Rows of a block of strands with N elements.
constexpr int ConstantRows(Kind kind, int N) {
  return kFirstElement +
         N * (kind == Kind::kWound ? int{kConstantsPerWoundElement} : int{kConstantsPerElement});
}
constexpr int StateRowsPerElement(Kind kind) {
  return kind == Kind::kWound ? int{kStatePerWoundElement} : int{kStatePerElement};
}

}  // namespace mane::rod::layout
