#pragma once

#include <optional>
#include <vector>

#include "mane/head.h"
#include "mane/v1/animation.pb.h"

namespace mane::inline client {

/// What a head has yet to tell the server: one slot for each kind of message, so that it cannot
/// grow. A newer pose replaces an older one; a teleport also replaces a pose pushed before it;
/// environments merge, and so do models. Not thread-safe.
class Outbox {
 public:
  void PutPose(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies = {});
  void PutTeleport(double time_s, const Pose& pose, const std::vector<BodyPose>& bodies = {});
  void PutReset() { reset_ = true; }
  void PutEnvironment(const Environment& change);
  void PutModel(AnimationModel model, const std::optional<BeamMotion>& beam);

  bool empty() const { return !environment_ && !model_ && !reset_ && !teleport_ && !pose_; }
  /// Removes and returns the next message: environment, model, reset, teleport, then pose, so that
  /// a frame shows all that was asked before its pose. The outbox must not be empty.
  v1::AnimateRequest Take();

 private:
  std::optional<Environment> environment_;
  std::optional<v1::SetModel> model_;
  bool reset_ = false;
  std::optional<v1::HeadPose> teleport_;
  std::optional<v1::HeadPose> pose_;
};

}  // namespace mane::inline client
