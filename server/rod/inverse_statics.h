#pragma once

#include <Eigen/Core>

#include <span>

#include "math/rigid.h"
#include "rod/statics.h"
#include "rod/strand.h"

namespace mane::rod {

/// What a strand may become so as to hold a shape.
struct HoldOptions {
  /// Range of the factor on the stiffness of the strand, torsion and bending alike, such as
  /// E_min / E and E_max / E; 0 < min <= max.
  double min_stiffness_factor = 1;
  double max_stiffness_factor = 1;
  /// Lowest scaled eigenvalue that counts as held, in [0, 1): 0 is the brink of buckling, 1 a
  /// strand without weight. Too low, and a small push finds another rest shape.
  double margin = 0.02;
  /// Largest angle by which the shape is pushed along its softest mode, to either side, before it
  /// settles [rad].
  double push = 0.02;
  /// The longest time step in which a held shape must stay [s], so tried (rod.md, I5); 0: statics
  /// alone tells.
  double longest_step = 0;
};

/// What came of it.
struct HoldReport {
  bool held = false;            ///< lowest_eigenvalue >= margin, and it stays in longest_step.
  double stiffness_factor = 1;  ///< That was applied.
  /// The factor that would hold the shape: the least one within the options' margin, or the first
  /// tried with which it stays, which the applied one falls short of where the shape is not held.
  /// The largest tried where it stays with none.
  double needed_factor = 0;
  /// Of the energy's Hessian at the shape, scaled by the stiffness (rod.md, I3).
  double lowest_eigenvalue = 0;
  /// Largest |kappa^n - kappa*| of an element [rad/m]: how far weight would bend the strand.
  double natural_change = 0;
  /// After the push and SolveRestShape, the worse of both sides [m]: distance of the tip, and of
  /// the farthest element end, from where they should be. Where it is an equilibrium that does not
  /// stay, the largest within eight seconds of stepping and after settling from their end.
  double tip_deviation = 0;
  double largest_deviation = 0;
  StaticsReport settling;  ///< Of that side.
};

/// Inverse statics: gives `strand` the natural curvatures, and where the shape would buckle away
/// the stiffness, that make `theta` its rest shape (rod.md, Inverse statics, I1 to I5). The
/// equilibrium is exact to rounding and always exists; whether it is stable is what the stiffness
/// decides. The factor nearest to 1 that the options allow is taken where it holds the shape, else
/// the smallest that does, else the largest allowed; `theta` is then a saddle, and the deviations
/// tell where the strand goes instead. With a longest step, a factor
/// holds the shape only if Stays says so too; larger margins are tried up to the range's end.
///
/// @param strand   lengths, stiffness and density are read, natural and stiffness are written.
/// @param clamp    root frame; only its rotation matters.
/// @param gravity  [m/s^2], in the frame of `clamp`'s parent.
/// @param theta    the wanted element angles [rad], (N), finite.
/// @param rest     where not empty, (N): the rest shape that the settling reached [rad].
HoldReport HoldShape(Strand& strand, const math::Pose& clamp, const Eigen::Vector3d& gravity,
                     std::span<const Eigen::Vector3d> theta, const HoldOptions& options = {},
                     std::span<Eigen::Vector3d> rest = {});

}  // namespace mane::rod
