#pragma once

#include <string>

#include "base/result.h"
#include "mane/v1/animation.pb.h"
#include "session/command.h"
#include "session/frame.h"
#include "session/head_session.h"

namespace mane::rpc {

/// Messages of animation.proto to the domain and back. Every number is checked here: `field` is the
/// path of the message, which errors name.

/// Largest coordinate [m] and time [s] that are accepted, by absolute value.
inline constexpr double kMaxCoordinate = 1e6;
inline constexpr double kMaxTime = 1e12;

Result<Eigen::Vector3d> ToVector(const v1::Vector3& message, const std::string& field,
                                 double limit);
/// A unit quaternion; a norm within 1 % of one is normalised.
Result<Eigen::Quaterniond> ToQuaternion(const v1::Quaternion& message, const std::string& field);
Result<math::Pose> ToPose(const v1::Pose& message, const std::string& field);
void FromPose(const math::Pose& pose, v1::Pose* message);

/// @param groom  whose bodies the message may name.
Result<session::PoseCommand> ToPoseCommand(const v1::HeadPose& message, const std::string& field,
                                           const groom::Groom& groom);
Result<session::EnvironmentCommand> ToEnvironmentCommand(const v1::Environment& message,
                                                         const std::string& field);
/// Surroundings of a new head: the defaults changed by `message`.
Result<head::Environment> ToEnvironment(const v1::Environment& message, const std::string& field);
/// A view from the fields that OpenHead and BakeAnimationRequest share.
Result<head::View> ToView(v1::FrameFormat format, v1::Space space, uint32_t points_per_guide,
                          const std::string& field);
Result<session::HeadOptions> ToHeadOptions(const v1::OpenHead& message);

v1::FrameFormat FromFormat(head::FrameFormat format);
v1::Space FromSpace(head::Space space);
void FromFrame(const session::Frame& frame, uint32_t skipped, v1::HairFrame* message);
void FromNotice(const session::Notice& notice, v1::Notice* message);

}  // namespace mane::rpc
