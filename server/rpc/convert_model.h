#pragma once

#include <string>

#include "base/result.h"
#include "head/frame.h"
#include "head/model.h"
#include "mane/v1/animation.pb.h"

namespace mane::rpc {

/// What beams are like; INVALID_ARGUMENT names a part of `field`, the path of the message.
Result<head::BeamOptions> ToBeamOptions(const v1::BeamMotion& message, const std::string& field);

/// How a head is to be animated whose frames are of `format`, from fields `model` and `beam` of the
/// message whose path is `field`, empty or ending in a dot. INVALID_ARGUMENT names `model` where
/// such frames cannot show it.
///
/// @param beam  what beams are like where the message does not say it.
template <typename Message>
Result<head::ModelOptions> ToModelOptions(const Message& message, head::FrameFormat format,
                                          const head::BeamOptions& beam, const std::string& field);

v1::AnimationModel FromModel(head::Model model);

}  // namespace mane::rpc
