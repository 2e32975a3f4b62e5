#pragma once

/// Numbers of the time step (rod.md, Time step), the same for the double-precision step and for the
/// batched kernels. Includes nothing: kernels may share no function with other sources.
namespace mane::rod {

/// The field-momentum theta-scheme: one linear solve a step, stable at any step size. kTheta = 1/2
/// is second order but may gain energy through gravity where nothing damps; 1 damps most.
inline constexpr double kTheta = 0.55;

/// Internal friction is at least this times h K: what has next to no inertia, such as the twist of
/// straight hair, follows its loads within a step instead of overshooting them (rod.md, S10).
inline constexpr double kLeastFriction = 0.5;

/// An element turns by at most this in a step [rad]: beyond it the linearisation means nothing, and
/// elements that wind often have next to no inertia that would hold them back (rod.md, S11).
inline constexpr double kLargestTurn = 1e3;

/// Points of the inertia integrals in each element: the inertia is good to 5e-8 for an element of 1
/// rad and to 1e-4 at 3 rad. Too few for a tightly wound one is inaccurate, never unstable (rod.md,
/// Quadrature).
inline constexpr int kGaussPoints = 4;

/// Gauss-Legendre on [0, 1], as math::GaussLegendre(kGaussPoints).
struct GaussRule {
  double nodes[kGaussPoints];
  double weights[kGaussPoints];
};
inline constexpr GaussRule kGauss = {
    {0.069431844202973712, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629},
    {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693}};

}  // namespace mane::rod
