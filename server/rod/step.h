#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/scheme.h"
#include "rod/strand.h"

namespace mane::rod {

/// What moves: views into arrays that the caller owns.
struct StrandState {
  std::span<Eigen::Vector3d> theta;  ///< Element angles l_Q kappa_Q [rad], (N).
  std::span<Eigen::Vector3d> rate;   ///< d theta/dt over the last step [rad/s], (N).
  std::span<Eigen::Vector3d>
      velocity;  ///< dr/dt at the Gauss points, world [m/s], (N x kGaussPoints).
};

/// What surrounds a strand, constant over a step.
struct Surroundings {
  Eigen::Vector3d gravity{0, -9.81, 0};            ///< World [m/s^2].
  Eigen::Vector3d wind = Eigen::Vector3d::Zero();  ///< Air velocity, world [m/s].
  double internal_friction_scale = 1;              ///< Factor on gamma, >= 0.
  double air_drag_scale = 1;                       ///< Factor on nu, >= 0.
};

/// Root frames in the world at the start and at the end of a step of `dt` [s] > 0. The clamp moves
/// at constant linear and angular velocity between them, by the shorter turn.
struct ClampMotion {
  math::Pose begin;
  math::Pose end;
  double dt;
};

/// An element of n unknowns, linearised at the extrapolated ones (rod.md, S2), and what its
/// elimination leaves (S7). World coordinates, from the element's left end [m].
template <int n>
struct LinearElement {
  static constexpr int kPoints = n == 4 ? kBeads : kGaussPoints;
  double length;  ///< [m]
  double mass;    ///< [kg]
  double rotary;  ///< mu of S12; 0 for a coil.
  Eigen::Matrix<double, n, n> K;
  Eigen::Matrix<double, n, 1> strain;      ///< x - x^n at the start of the step.
  Eigen::Vector3d d;                       ///< Right end.
  Eigen::Matrix<double, 6, n> S;           ///< Right end's twist per rate.
  Eigen::Vector3d c;                       ///< Centre of mass.
  Eigen::Matrix<double, 3, n> G;           ///< Its velocity per rate.
  Eigen::Vector3d r[kPoints];              ///< Gauss points, or beads of a coil (C7).
  Eigen::Matrix<double, 3, n> J[kPoints];  ///< Their velocity per rate.
  Eigen::Matrix3d weight;                  ///< Turning stiffness of weight at the right end (S9).
  Eigen::Vector3d spin;                    ///< Right end's extrapolated angular velocity [rad/s].
  Eigen::Matrix<double, n, 6> L;           ///< rate = k - L V
  Eigen::Matrix<double, n, 1> k;
};

/// What presses or rubs on a strand at one of its points, linear in the point's velocity u [m/s]
/// (rod.md, S13): the step's cost gains 1/2 u.W u - p.u.
struct PointLoad {
  int element;        ///< Of the strand, and
  double fraction;    ///< where on it, in [0, 1].
  Eigen::Matrix3d W;  ///< Symmetric, positive semidefinite [kg], world.
  Eigen::Vector3d p;  ///< [kg m/s], world.
  /// Unit vector along which the element may not leave faster than the surface moves, so that what
  /// stops there does not bounce (S14); zero for none.
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  double surface_speed = 0;  ///< Along the normal, of what it would bounce off [m/s].
};

/// A load and where it acts, linearised like an element.
struct LinearLoad {
  Eigen::Matrix3d W;
  Eigen::Vector3d p;
  Eigen::Vector3d normal;
  double surface_speed;
  Eigen::Vector3d r;  ///< From the element's left end [m].
  Eigen::Matrix3d J;  ///< Velocity per rate of the element.
};

/// Memory of one worker's steps; grows to the longest strand it has seen and is reused.
struct StepScratch {
  std::vector<LinearElement<3>> elements;
  std::vector<LinearLoad> loads;
  std::vector<int> first_load;  ///< By element, and their number at the end.
};

/// Advances one strand by one step. O(N); allocates only while `scratch` grows.
///
/// @param loads  by element, root first.
/// @param state  in: a finite state at the start; out: the state at the end.
/// @return false when the result is not finite; `state` is then unspecified and must be reset.
[[nodiscard]] bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
                        std::span<const PointLoad> loads, StrandState state, StepScratch& scratch);
/// The same without loads.
[[nodiscard]] bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
                        StrandState state, StepScratch& scratch);

}  // namespace mane::rod
