#pragma once

#include <google/protobuf/repeated_field.h>

#include <string>

#include "base/result.h"
#include "groom/groom.h"
#include "mane/v1/animation.pb.h"
#include "session/body_poses.h"

namespace mane::rpc {

/// Index among the moving bodies of `groom` of the one called `name`; kInvalidArgument naming
/// `field` if there is none.
[[nodiscard]] Result<size_t> FindMovingBody(const groom::Groom& groom, const std::string& name,
                                            const std::string& field);

[[nodiscard]] size_t MovingCount(const groom::Groom& groom);

/// Poses that a message gives to moving bodies. kInvalidArgument names `<field>[i].name` for a name
/// that no moving body has, or a second time, and what is wrong with a pose.
[[nodiscard]] Result<session::BodyPoses> ToBodyPoses(
    const google::protobuf::RepeatedPtrField<v1::BodyPose>& messages, const std::string& field,
    const groom::Groom& groom);

}  // namespace mane::rpc
