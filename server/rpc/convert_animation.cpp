#include "rpc/convert_animation.h"

#include <cmath>

#include "rpc/convert_body_poses.h"
#include "rpc/convert_model.h"
#include "rpc/convert_values.h"
#include "rpc/limits.h"

namespace mane::rpc {
namespace {

constexpr double kMaxWind = 100;
constexpr double kMaxGravity = 1000;
constexpr double kMaxScale = 1000;
constexpr double kMaxDetailTolerance = 10;  // [m]
constexpr size_t kMaxRequestId = 64;

// Zero stands for the default.
Result<uint32_t> CountOr(const std::string& field, uint32_t value, uint32_t fallback, uint32_t low,
                         uint32_t high) {
  if (value == 0) return fallback;
  if (const auto ok = CheckRange(field, value, low, high); !ok) return ok.error();
  return value;
}

}  // namespace

Result<Eigen::Vector3d> ToVector(const v1::Vector3& message, const std::string& field,
                                 double limit) {
  if (const auto ok = CheckRange(field + ".x", message.x(), -limit, limit); !ok) return ok.error();
  if (const auto ok = CheckRange(field + ".y", message.y(), -limit, limit); !ok) return ok.error();
  if (const auto ok = CheckRange(field + ".z", message.z(), -limit, limit); !ok) return ok.error();
  return ToVector(message);
}

Result<Eigen::Quaterniond> ToQuaternion(const v1::Quaternion& message, const std::string& field) {
  const Eigen::Quaterniond q = ToQuaternion(message);
  const double norm = q.norm();
  if (!(std::abs(norm - 1) <= 0.01)) {
    return InvalidArgument(
        field, fmt::format("{} is ({}, {}, {}, {}), of norm {}; a rotation's norm must be within "
                           "0.99 and 1.01",
                           field, message.x(), message.y(), message.z(), message.w(), norm));
  }
  return q.normalized();
}

Result<math::Pose> ToPose(const v1::Pose& message, const std::string& field) {
  math::Pose pose;
  const auto p = ToVector(message.position(), field + ".position", kMaxCoordinate);
  if (!p) return p.error();
  pose.p = *p;
  if (message.has_orientation()) {
    const auto q = ToQuaternion(message.orientation(), field + ".orientation");
    if (!q) return q.error();
    pose.q = *q;
  }
  return pose;
}

void FromPose(const math::Pose& pose, v1::Pose* message) {
  FromVector(pose.p, message->mutable_position());
  FromQuaternion(pose.q, message->mutable_orientation());
}

Result<session::PoseCommand> ToPoseCommand(const v1::HeadPose& message, const std::string& field,
                                           const groom::Groom& groom) {
  if (const auto ok = CheckRange(field + ".time_s", message.time_s(), -kMaxTime, kMaxTime); !ok) {
    return ok.error();
  }
  const auto pose = ToPose(message.pose(), field + ".pose");
  if (!pose) return pose.error();
  auto bodies = ToBodyPoses(message.bodies(), field + ".bodies", groom);
  if (!bodies) return bodies.error();
  return session::PoseCommand{message.time_s(), *pose, false, *std::move(bodies)};
}

// Gusts and eddies.
Result<void> ToWindVariation(const v1::Environment& message, const std::string& field,
                             session::EnvironmentCommand* change) {
  const auto take = [&](bool has, double value, const char* name, double low, double high,
                        std::optional<double>* target) -> Result<void> {
    if (!has) return {};
    *target = value;
    return CheckRange(field + name, value, low, high);
  };
  if (message.has_wind_seed()) change->wind_seed = message.wind_seed();
  for (const auto& ok : {take(message.has_gust_strength(), message.gust_strength(),
                              ".gust_strength", 0, 2, &change->gust_strength),
                         take(message.has_gust_period_s(), message.gust_period_s(),
                              ".gust_period_s", 0.1, 100, &change->gust_period),
                         take(message.has_turbulence_speed(), message.turbulence_speed(),
                              ".turbulence_speed", 0, 50, &change->turbulence_speed),
                         take(message.has_turbulence_size_m(), message.turbulence_size_m(),
                              ".turbulence_size_m", 0.01, 100, &change->turbulence_size)}) {
    if (!ok) return ok;
  }
  return {};
}

Result<session::EnvironmentCommand> ToEnvironmentCommand(const v1::Environment& message,
                                                         const std::string& field) {
  session::EnvironmentCommand change;
  if (message.has_wind_velocity()) {
    const auto wind = ToVector(message.wind_velocity(), field + ".wind_velocity", kMaxWind);
    if (!wind) return wind.error();
    change.wind = *wind;
  }
  if (message.has_gravity()) {
    const auto gravity = ToVector(message.gravity(), field + ".gravity", kMaxGravity);
    if (!gravity) return gravity.error();
    change.gravity = *gravity;
  }
  if (message.has_internal_friction_scale()) {
    change.internal_friction_scale = message.internal_friction_scale();
    const auto ok = CheckRange(field + ".internal_friction_scale",
                               message.internal_friction_scale(), 0, kMaxScale);
    if (!ok) return ok.error();
  }
  if (message.has_air_drag_scale()) {
    change.air_drag_scale = message.air_drag_scale();
    const auto ok = CheckRange(field + ".air_drag_scale", message.air_drag_scale(), 0, kMaxScale);
    if (!ok) return ok.error();
  }
  if (message.has_detail_tolerance_m()) {
    change.detail_tolerance = message.detail_tolerance_m();
    const auto ok = CheckRange(field + ".detail_tolerance_m", message.detail_tolerance_m(), 0,
                               kMaxDetailTolerance);
    if (!ok) return ok.error();
  }
  if (const auto ok = ToWindVariation(message, field, &change); !ok) return ok.error();
  return change;
}

Result<head::Environment> ToEnvironment(const v1::Environment& message, const std::string& field) {
  const auto change = ToEnvironmentCommand(message, field);
  if (!change) return change.error();
  head::Environment environment;
  session::Apply(*change, &environment);
  return environment;
}

Result<head::View> ToView(v1::FrameFormat format, v1::Space space, uint32_t points_per_guide,
                          const std::string& field) {
  head::View view;
  switch (format) {
    case v1::FRAME_FORMAT_UNSPECIFIED:
    case v1::FRAME_FORMAT_POSITIONS_FLOAT32:
      view.format = head::FrameFormat::kPositionsFloat32;
      break;
    case v1::FRAME_FORMAT_POSITIONS_QUANTIZED16:
      view.format = head::FrameFormat::kPositionsQuantized16;
      break;
    case v1::FRAME_FORMAT_GENERALIZED:
      view.format = head::FrameFormat::kGeneralized;
      break;
    default:
      return InvalidArgument(field + "format",
                             fmt::format("{}format is {}; it must be a FrameFormat, 1 to 3", field,
                                         static_cast<int>(format)));
  }
  if (space < v1::SPACE_UNSPECIFIED || space > v1::SPACE_HEAD) {
    return InvalidArgument(field + "space",
                           fmt::format("{}space is {}; it must be SPACE_WORLD or SPACE_HEAD", field,
                                       static_cast<int>(space)));
  }
  view.space = space == v1::SPACE_HEAD ? head::Space::kHead : head::Space::kWorld;
  const auto points = CountOr(field + "points_per_guide", points_per_guide, 16, 2, 256);
  if (!points) return points.error();
  view.points_per_guide = static_cast<int>(*points);
  return view;
}

Result<session::HeadOptions> ToHeadOptions(const v1::OpenHead& message) {
  session::HeadOptions options;
  if (message.pacing() != v1::PACING_REALTIME && message.pacing() != v1::PACING_LOCKSTEP) {
    return InvalidArgument("open.pacing",
                           fmt::format("open.pacing is {}; it must be PACING_REALTIME or "
                                       "PACING_LOCKSTEP",
                                       static_cast<int>(message.pacing())));
  }
  options.pacing = message.pacing() == v1::PACING_REALTIME ? session::Pacing::kRealtime
                                                           : session::Pacing::kLockstep;
  const auto view = ToView(message.format(), message.space(), message.points_per_guide(), "open.");
  if (!view) return view.error();
  options.view = *view;
  if (message.rate_hz() != 0) {
    if (const auto ok = CheckRange("open.rate_hz", message.rate_hz(), 1, 240); !ok) {
      return ok.error();
    }
    options.rate_hz = message.rate_hz();
  }
  const auto substeps = CountOr("open.substeps", message.substeps(), 1, 1, 64);
  if (!substeps) return substeps.error();
  options.substeps = static_cast<int>(*substeps);
  if (const auto ok = CheckRange("open.pose_delay_s", message.pose_delay_s(), 0, 0.25); !ok) {
    return ok.error();
  }
  options.pose_delay = message.pose_delay_s();
  const auto unacked = CountOr("open.max_unacked_frames", message.max_unacked_frames(), 3, 1, 16);
  if (!unacked) return unacked.error();
  options.max_unacked = static_cast<int>(*unacked);
  const auto pose = ToPose(message.initial_pose(), "open.initial_pose");
  if (!pose) return pose.error();
  options.initial_pose = *pose;
  const auto environment = ToEnvironment(message.environment(), "open.environment");
  if (!environment) return environment.error();
  options.environment = *environment;
  options.diagnostics = message.diagnostics();
  const auto model = ToModelOptions(message, options.view.format, {}, "open.");
  if (!model) return model.error();
  options.model = *model;
  options.may_shed = message.may_shed();
  if (message.request_id().size() > kMaxRequestId) {
    return InvalidArgument("open.request_id",
                           fmt::format("open.request_id has {} bytes; at most {} are allowed",
                                       message.request_id().size(), kMaxRequestId));
  }
  return options;
}

v1::FrameFormat FromFormat(head::FrameFormat format) {
  switch (format) {
    case head::FrameFormat::kPositionsFloat32:
      return v1::FRAME_FORMAT_POSITIONS_FLOAT32;
    case head::FrameFormat::kPositionsQuantized16:
      return v1::FRAME_FORMAT_POSITIONS_QUANTIZED16;
    case head::FrameFormat::kGeneralized:
      return v1::FRAME_FORMAT_GENERALIZED;
  }
  return v1::FRAME_FORMAT_UNSPECIFIED;
}

v1::Space FromSpace(head::Space space) {
  return space == head::Space::kHead ? v1::SPACE_HEAD : v1::SPACE_WORLD;
}

void FromFrame(const session::Frame& frame, uint32_t skipped, v1::HairFrame* message) {
  message->set_index(frame.index);
  message->set_time_s(frame.time);
  FromPose(frame.pose, message->mutable_head_pose());
  message->set_data(frame.data);
  message->set_skipped(skipped);
  message->set_newest_pose_time_s(frame.newest_pose_time);
  message->set_step_ms(1e3 * frame.step_seconds);
  message->set_repaired_guides(static_cast<uint32_t>(frame.repaired_guides));
  message->set_stepped_elements(static_cast<uint32_t>(frame.stepped_elements));
  message->set_model(FromModel(frame.model));
  if (!frame.diagnostics) return;
  v1::Diagnostics* diagnostics = message->mutable_diagnostics();
  diagnostics->set_kinetic_energy_j(frame.diagnostics->kinetic_energy);
  diagnostics->set_elastic_energy_j(frame.diagnostics->elastic_energy);
  diagnostics->set_gravity_energy_j(frame.diagnostics->gravity_energy);
  diagnostics->set_largest_angle_rad(frame.diagnostics->largest_angle);
  diagnostics->set_imbalance(frame.diagnostics->imbalance);
}

void FromNotice(const session::Notice& notice, v1::Notice* message) {
  message->set_count(notice.count);
  switch (notice.code) {
    case session::Notice::Code::kLate:
      message->set_code(v1::Notice::CODE_LATE);
      message->set_message(fmt::format("the server missed {} frames", notice.count));
      break;
    case session::Notice::Code::kDraining:
      message->set_code(v1::Notice::CODE_DRAINING);
      message->set_message("the server is about to stop; reconnect");
      break;
    case session::Notice::Code::kNoPoses:
      message->set_code(v1::Notice::CODE_NO_POSES);
      message->set_message("no pose for over a second; the head stands still");
      break;
    case session::Notice::Code::kModel:
      message->set_code(v1::Notice::CODE_MODEL);
      message->set_message(notice.why);
      message->set_model(FromModel(notice.model));
      break;
  }
}

}  // namespace mane::rpc
