#include "session/body_poses.h"

#include "base/check.h"

namespace mane::session {

void Apply(const BodyPoses& change, BodyPoses* poses) {
  if (change.empty()) return;
  poses->resize(change.size());
  for (size_t i = 0; i < change.size(); ++i) {
    if (change[i]) (*poses)[i] = change[i];
  }
}

std::vector<math::Pose> PlaceBodies(const head::Bodies* bodies, const math::Pose& head,
                                    const BodyPoses& named) {
  if (bodies == nullptr) return {};
  std::vector<math::Pose> poses = head::BodiesAtRest(*bodies, head);
  MANE_CHECK(named.empty() || named.size() == poses.size());
  for (size_t i = 0; i < named.size(); ++i) {
    if (named[i]) poses[i] = *named[i];
  }
  return poses;
}

}  // namespace mane::session
