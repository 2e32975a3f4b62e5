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

/// Memory of one worker's steps; grows to the longest strand it has seen and is reused.
struct StepScratch {
  std::vector<LinearElement<3>> elements;
};

/// Advances one strand by one step. O(N); allocates only while `scratch` grows.
///
/// @param state  in: a finite state at the start; out: the state at the end.
/// @return false when the result is not finite; `state` is then unspecified and must be reset.
[[nodiscard]] bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
                        StrandState state, StepScratch& scratch);

}  // namespace mane::rod
