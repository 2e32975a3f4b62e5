#pragma once

#include <Eigen/Core>

#include <optional>
#include <variant>

#include "head/frame.h"
#include "head/head.h"
#include "head/model.h"
#include "math/rigid.h"
#include "session/body_poses.h"

namespace mane::session {

/// How simulated time passes; see proto/mane/v1/animation.proto Pacing.
enum class Pacing { kRealtime, kLockstep };

/// What a client chooses when it opens a head. Ranges are those of the proto's OpenHead.
struct HeadOptions {
  Pacing pacing = Pacing::kRealtime;
  head::View view;
  double rate_hz = 60;      ///< Real time only.
  int substeps = 1;         ///< Time steps per frame.
  double pose_delay = 0;    ///< [s], real time only.
  int max_unacked = 3;      ///< Frames under way, real time only; fewer where they are large.
  math::Pose initial_pose;  ///< Before the first pose.
  head::Environment environment;
  bool diagnostics = false;  ///< Every frame carries them, but those of beams.
  head::ModelOptions model;  ///< At first; its beams also for what the head is switched to.
  /// Whether beams may stand in while frames come late (Shedding); real time, and where frames are
  /// not generalized.
  bool may_shed = false;
};

/// A timed pose, head -> world; `teleport` moves head, bodies and hair without dynamics.
struct PoseCommand {
  double time;  ///< Client's clock [s].
  math::Pose pose;
  bool teleport = false;
  BodyPoses bodies = {};  ///< Of moving bodies; those it does not name stay where they are.
};

/// Least time between poses [s].
inline constexpr double kLeastPoseGap = 1e-6;
/// Longest time between poses that are all shown, of lockstep heads and bakes [s]: a second, and
/// what rounding of its two ends may add, on clocks that count from 1970, too.
inline constexpr double kLongestPoseGap = 1 + 1e-6;

/// Hair to its rest shape, standing still.
struct ResetCommand {};

/// Changes to what surrounds the hair; what is empty stays.
struct EnvironmentCommand {
  std::optional<Eigen::Vector3d> wind = std::nullopt;
  std::optional<Eigen::Vector3d> gravity = std::nullopt;
  std::optional<double> internal_friction_scale = std::nullopt;
  std::optional<double> air_drag_scale = std::nullopt;
  std::optional<double> gust_strength = std::nullopt;
  std::optional<double> gust_period = std::nullopt;
  std::optional<double> turbulence_speed = std::nullopt;
  std::optional<double> turbulence_size = std::nullopt;
  std::optional<uint64_t> wind_seed = std::nullopt;
  std::optional<double> detail_tolerance = std::nullopt;
};

inline void Apply(const EnvironmentCommand& change, head::Environment* environment) {
  environment->wind = change.wind.value_or(environment->wind);
  environment->gravity = change.gravity.value_or(environment->gravity);
  environment->internal_friction_scale =
      change.internal_friction_scale.value_or(environment->internal_friction_scale);
  environment->air_drag_scale = change.air_drag_scale.value_or(environment->air_drag_scale);
  head::WindVariation& wind = environment->wind_variation;
  wind.gust_strength = change.gust_strength.value_or(wind.gust_strength);
  wind.gust_period = change.gust_period.value_or(wind.gust_period);
  wind.turbulence_speed = change.turbulence_speed.value_or(wind.turbulence_speed);
  wind.turbulence_size = change.turbulence_size.value_or(wind.turbulence_size);
  wind.seed = change.wind_seed.value_or(wind.seed);
  environment->detail_tolerance = change.detail_tolerance.value_or(environment->detail_tolerance);
}

/// How the hair is animated from the next step on. Beams are nothing that generalized frames show.
struct ModelCommand {
  head::ModelOptions model;
};

using Command = std::variant<PoseCommand, ResetCommand, EnvironmentCommand, ModelCommand>;

}  // namespace mane::session
