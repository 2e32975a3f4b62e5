#include "mane/head.h"

#include <utility>

#include "head_stream.h"

namespace mane::inline client {

Head::Head(std::shared_ptr<HeadStream> stream) : stream_(std::move(stream)) {}
Head::Head(Head&&) noexcept = default;

Head& Head::operator=(Head&& other) noexcept {
  if (this != &other) {
    if (stream_) stream_->Close();
    stream_ = std::move(other.stream_);
  }
  return *this;
}

Head::~Head() {
  if (stream_) stream_->Close();
}

Result<void> Head::WaitUntilStreaming(std::chrono::milliseconds timeout) {
  return stream_->WaitUntilStreaming(timeout);
}

Result<void> Head::PushPose(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies) {
  return stream_->Push(HeadStream::Motion::kPose, time_s, pose, bodies);
}

Result<void> Head::Teleport(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies) {
  return stream_->Push(HeadStream::Motion::kTeleport, time_s, pose, bodies);
}

Result<void> Head::Reset() { return stream_->Reset(); }

Result<void> Head::SetEnvironment(const Environment& environment) {
  return stream_->SetEnvironment(environment);
}

Result<void> Head::SetModel(AnimationModel model, const std::optional<BeamMotion>& beam) {
  return stream_->SetModel(model, beam);
}

std::shared_ptr<const Frame> Head::NewestFrame() { return stream_->NewestFrame(); }

Result<std::shared_ptr<const Frame>> Head::Step(double time_s, const Pose& pose,
                                                const std::vector<BodyPose>& bodies) {
  return stream_->Step(HeadStream::Motion::kPose, time_s, pose, bodies);
}

Result<std::shared_ptr<const Frame>> Head::StepTeleport(double time_s, const Pose& pose,
                                                        const std::vector<BodyPose>& bodies) {
  return stream_->Step(HeadStream::Motion::kTeleport, time_s, pose, bodies);
}

HeadStatus Head::Status() const { return stream_->Status(); }

void Head::Close() { stream_->Close(); }

}  // namespace mane::inline client
