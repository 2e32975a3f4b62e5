#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/helix.h"
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

/// Memory of one worker's steps; grows to the longest strand it has seen and is reused.
struct StepScratch {
  struct Element {
    Eigen::Matrix3d R;              ///< Left frame at the linearisation, world.
    Eigen::Vector3d d;              ///< Right end from left end, world [m].
    Eigen::Matrix<double, 6, 3> S;  ///< Right end's twist per rate.
    Eigen::Matrix<double, 3, 6> L;  ///< rate = k - L V
    Eigen::Vector3d k;
    Eigen::Matrix3d weight;           ///< Turning stiffness of weight at the right end (S9).
    Eigen::Vector3d spin;             ///< Right end's extrapolated angular velocity, world [rad/s].
    Eigen::Vector3d r[kGaussPoints];  ///< Gauss points from the left end, world [m].
    Eigen::Matrix3d J[kGaussPoints];  ///< Their velocity per rate.
  };
  std::vector<Element> elements;
  std::vector<ElementEnd> ends;
};

/// Advances one strand by one step. O(N); allocates only while `scratch` grows.
///
/// @param state  in: a finite state at the start; out: the state at the end.
/// @return false when the result is not finite; `state` is then unspecified and must be reset.
[[nodiscard]] bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
                        StrandState state, StepScratch& scratch);

}  // namespace mane::rod
