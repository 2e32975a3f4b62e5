#include "rpc/convert_body_poses.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "base/text.h"
#include "rpc/convert_animation.h"

namespace mane::rpc {

Result<size_t> FindMovingBody(const groom::Groom& groom, const std::string& name,
                              const std::string& field) {
  std::vector<std::string_view> names;
  for (const groom::Body& body : groom.bodies) {
    if (!body.moving) continue;
    if (body.name == name) return names.size();
    names.push_back(body.name);
  }
  return InvalidArgument(
      field,
      names.empty()
          ? fmt::format("{} is \"{}\"; the groom has no moving body", field, base::Shown(name))
          : fmt::format("{} is \"{}\"; it must be one of the groom's moving bodies: {}", field,
                        base::Shown(name), fmt::join(names, ", ")));
}

size_t MovingCount(const groom::Groom& groom) {
  return static_cast<size_t>(std::ranges::count_if(groom.bodies, &groom::Body::moving));
}

Result<session::BodyPoses> ToBodyPoses(
    const google::protobuf::RepeatedPtrField<v1::BodyPose>& messages, const std::string& field,
    const groom::Groom& groom) {
  session::BodyPoses poses;
  if (messages.empty()) return poses;
  poses.resize(MovingCount(groom));
  for (int i = 0; i < messages.size(); ++i) {
    const std::string path = fmt::format("{}[{}].", field, i);
    const auto body = FindMovingBody(groom, messages[i].name(), path + "name");
    if (!body) return body.error();
    if (poses[*body]) {
      return InvalidArgument(path + "name",
                             fmt::format("{}name is \"{}\", which the message names twice", path,
                                         base::Shown(messages[i].name())));
    }
    const auto pose = ToPose(messages[i].pose(), path + "pose");
    if (!pose) return pose.error();
    poses[*body] = *pose;
  }
  return poses;
}

}  // namespace mane::rpc
