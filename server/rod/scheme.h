#pragma once

/// Numbers of the time step (rod.md, Time step), the same for the double-precision step and for the
/// batched kernels. Includes nothing: kernels may share no function with other sources.
namespace mane::rod {

/// The field-momentum theta-scheme: one linear solve a step, stable at any step size. kTheta = 1/2
/// is second order but may gain energy through gravity where nothing damps; 1 damps most.
inline constexpr double kTheta = 0.55;

/// No time step of a head is longer than this [s]: what hair of half a metre needs to hang still
/// (rod.md, S9, S10).
inline constexpr double kLongestStep = 1.0 / 60;

/// Internal friction is at least this times h K: what has next to no inertia, such as the twist of
/// straight hair, follows its loads within a step instead of overshooting them (rod.md, S10).
inline constexpr double kLeastFriction = 0.5;

/// An element turns by at most this in a step [rad]: beyond it the linearisation means nothing, and
/// elements that wind often have next to no inertia that would hold them back (rod.md, S11).
inline constexpr double kLargestTurn = 1e3;

/// Points and weights on [0, 1].
template <int n>
struct PointRule {
  double nodes[n];
  double weights[n];
};

/// Points of the inertia integrals in each element of a plain strand: Gauss-Legendre on [0, 1], as
/// math::GaussLegendre(3). Three are as good as any more of them up to elements of half a turn; too
/// few for a tightly wound one is inaccurate, never unstable (rod.md, Quadrature).
inline constexpr int kGaussPoints = 3;
inline constexpr PointRule<kGaussPoints> kGauss = {
    {0.11270166537925831, 0.5, 0.88729833462074169},
    {0.27777777777777778, 0.44444444444444444, 0.27777777777777778}};

/// Beads of a wound element, which carry its inertia (coil.md, C7): Gauss-Legendre, as
/// math::GaussLegendre(4).
inline constexpr int kBeads = 4;
inline constexpr PointRule<kBeads> kBeadRule = {
    {0.069431844202973712, 0.33000947820757187, 0.66999052179242813, 0.93056815579702629},
    {0.17392742256872693, 0.32607257743127307, 0.32607257743127307, 0.17392742256872693}};

}  // namespace mane::rod
