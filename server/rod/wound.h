#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "rod/coil_element.h"
#include "rod/step.h"
#include "rod/strand.h"

namespace mane::rod {

/// The axis of a wound strand turns by at most this [rad] from one element's natural coil to the
/// next's: up to here the natural shape's tip is within 2 % of the length (coil.md, C12).
inline constexpr double kLargestKink = 0.5;

/// Turns of a strand's natural shape about its coil's axis, the sum of |kappa^n| l / (2 pi); 0
/// where the natural curvature of an element has no bend: neither straight hair nor a pure twist is
/// a coil.
[[nodiscard]] double NaturalTurns(const Strand& strand);

/// Whether a strand is better modelled along its coil's axis (coil.md, Which strands): it winds
/// more often than its elements can follow, often enough that a coil's ends matter little, no
/// element less than a fifth of a turn or with hardly a bend, and its axis turns at no joint by
/// more than kLargestKink.
[[nodiscard]] bool IsWound(const Strand& strand);

/// What weight bends a hanging coil by, relative to its natural bending moment: the largest over
/// the elements of the weight beyond times the coil's radius over |EI kappa^n|, under standard
/// gravity. Above kMostCoilWeight it unwinds coils that are not even, and wound strands do not rest
/// (coil.md, Which strands). Needs NaturalTurns > 0.
[[nodiscard]] double CoilWeight(const Strand& strand);
inline constexpr double kMostCoilWeight = 0.4;

/// Constant description of a wound strand: the strand, and the coil of each element's natural
/// curvature.
struct WoundStrand {
  Strand strand;
  std::vector<Coil> coil;         ///< (N). The axis frame at the root is R coil[0].F (C10).
  std::vector<Vector4d> natural;  ///< x^n of the natural shape (C12) [rad], (N).
  Eigen::Vector3d root;           ///< Where the axis starts, in the clamp's frame (C10) [m].

  [[nodiscard]] int elements() const { return strand.elements(); }
};

/// Needs NaturalTurns > 0, not IsWound: the kinematics hold for any coil.
[[nodiscard]] WoundStrand MakeWound(Strand strand);

/// What moves: views into arrays that the caller owns. The natural shape is x =
/// WoundStrand::natural.
struct WoundState {
  std::span<Vector4d> x;                ///< l (u, b1, b2, xi) of each element [rad], (N).
  std::span<Vector4d> rate;             ///< dx/dt over the last step [rad/s], (N).
  std::span<Eigen::Vector3d> velocity;  ///< Of the beads (C7), world [m/s], (N x kBeads).
};

/// Memory of one worker's steps, as StepScratch.
struct WoundScratch {
  std::vector<LinearElement<4>> elements;
};

/// Advances one wound strand by one step, as Step of step.h does a plain one. O(N); allocates only
/// while `scratch` grows.
///
/// @return false when the result is not finite; `state` is then unspecified and must be reset.
[[nodiscard]] bool Step(const WoundStrand& wound, const ClampMotion& clamp, const Surroundings& air,
                        WoundState state, WoundScratch& scratch);

}  // namespace mane::rod
