#include <algorithm>

#include "convert.h"

namespace mane::inline client {
namespace {

// Of a Body or a ScalpContact.
template <typename From, typename To>
void PutFriction(const From& from, To* to) {
  to->set_material(static_cast<v1::Material>(from.material));
  if (from.friction) to->set_friction(*from.friction);
  if (from.friction_anisotropy) to->set_friction_anisotropy(*from.friction_anisotropy);
}

struct PutShape {
  v1::Body* to;

  void operator()(const EllipsoidBody& ellipsoid) const {
    *to->mutable_ellipsoid()->mutable_radii_m() = ToProto(ellipsoid.radii_m);
  }
  void operator()(const CapsuleBody& capsule) const {
    *to->mutable_capsule()->mutable_a() = ToProto(capsule.a);
    *to->mutable_capsule()->mutable_b() = ToProto(capsule.b);
    to->mutable_capsule()->set_radius_m(capsule.radius_m);
  }
  void operator()(const TriangleMesh& /*mesh*/) const { to->mutable_mesh(); }
};

MeshReport FromProto(const v1::MeshReport& report) {
  return {.triangles = report.triangles(),
          .holes = report.holes(),
          .inverted = report.inverted(),
          .max_error_m = report.max_error_m(),
          .bytes = report.bytes()};
}

}  // namespace

v1::Body ToProto(const Body& body) {
  v1::Body out;
  out.set_name(body.name);
  std::visit(PutShape{&out}, body.shape);
  PutFriction(body, &out);
  out.set_moving(body.moving);
  *out.mutable_pose() = ToProto(body.pose);
  return out;
}

v1::ScalpContact ToProto(const ScalpContact& contact) {
  v1::ScalpContact out;
  PutFriction(contact, &out);
  return out;
}

v1::BodyPose ToProto(const BodyPose& body) {
  v1::BodyPose out;
  out.set_name(body.name);
  *out.mutable_pose() = ToProto(body.pose);
  return out;
}

ScalpContact FromProto(const v1::ScalpContact& contact) {
  ScalpContact out;
  out.material = static_cast<Material>(contact.material());
  if (contact.has_friction()) out.friction = contact.friction();
  if (contact.has_friction_anisotropy()) out.friction_anisotropy = contact.friction_anisotropy();
  if (contact.has_mesh()) out.mesh = FromProto(contact.mesh());
  return out;
}

BodySummary FromProto(const v1::BodySummary& summary) {
  BodySummary out;
  out.name = summary.name();
  out.shape = static_cast<BodySummary::Shape>(summary.shape());
  out.moving = summary.moving();
  if (summary.has_mesh()) out.mesh = FromProto(summary.mesh());
  return out;
}

void Merge(const std::vector<BodyPose>& change, std::vector<BodyPose>& bodies) {
  for (const BodyPose& moved : change) {
    const auto known = std::find_if(bodies.begin(), bodies.end(),
                                    [&](const BodyPose& body) { return body.name == moved.name; });
    if (known == bodies.end()) {
      bodies.push_back(moved);
    } else {
      known->pose = moved.pose;
    }
  }
}

}  // namespace mane::inline client
