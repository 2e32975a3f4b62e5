#include "outbox.h"

#include <utility>

#include "convert.h"

namespace mane::inline client {
namespace {

v1::HeadPose Timed(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies) {
  v1::HeadPose out;
  out.set_time_s(time_s);
  *out.mutable_pose() = ToProto(pose);
  for (const BodyPose& body : bodies) *out.add_bodies() = ToProto(body);
  return out;
}

}  // namespace

void Outbox::PutPose(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies) {
  pose_ = Timed(time_s, pose, bodies);
}

void Outbox::PutTeleport(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies) {
  teleport_ = Timed(time_s, pose, bodies);
  pose_.reset();
}

void Outbox::PutEnvironment(const Environment& change) {
  if (!environment_) environment_.emplace();
  Merge(change, *environment_);
}

void Outbox::PutModel(AnimationModel model, const std::optional<BeamMotion>& beam) {
  if (!model_) model_.emplace();
  model_->set_model(static_cast<v1::AnimationModel>(model));
  if (beam) *model_->mutable_beam() = ToProto(*beam);
}

v1::AnimateRequest Outbox::Take() {
  v1::AnimateRequest request;
  if (environment_) {
    *request.mutable_environment() = ToProto(*std::exchange(environment_, std::nullopt));
  } else if (model_) {
    *request.mutable_model() = *std::exchange(model_, std::nullopt);
  } else if (std::exchange(reset_, false)) {
    request.mutable_reset();
  } else if (teleport_) {
    *request.mutable_teleport() = *std::exchange(teleport_, std::nullopt);
  } else {
    *request.mutable_pose() = *std::exchange(pose_, std::nullopt);
  }
  return request;
}

}  // namespace mane::inline client
