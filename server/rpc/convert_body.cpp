#include "rpc/convert_body.h"

#include <fmt/format.h>

#include <limits>
#include <memory>
#include <utility>

#include "groom/material.h"
#include "groom/validate_body.h"
#include "rpc/convert_animation.h"
#include "rpc/convert_values.h"

namespace mane::rpc {
namespace {

// Of a Body or ScalpContact; `path` leads to it.
template <typename Message>
Result<groom::Friction> ToFriction(const Message& message, const std::string& path) {
  static_assert(v1::MATERIAL_POLISHED == static_cast<int>(groom::Material::kPolished));
  if (message.material() < v1::MATERIAL_UNSPECIFIED || message.material() > v1::MATERIAL_POLISHED) {
    return InvalidArgument(
        path + "material",
        fmt::format("{}material is {}; it must be a Material, 0 to {}", path,
                    static_cast<int>(message.material()), static_cast<int>(v1::MATERIAL_POLISHED)));
  }
  groom::Friction friction = groom::FrictionOf(static_cast<groom::Material>(message.material()));
  if (message.has_friction()) friction.coefficient = message.friction();
  if (message.has_friction_anisotropy()) friction.anisotropy = message.friction_anisotropy();
  return friction;
}

template <typename Message>
void FromFriction(const groom::Friction& friction, Message* message) {
  message->set_friction(friction.coefficient);
  message->set_friction_anisotropy(friction.anisotropy);
}

struct ShapeWriter {
  v1::Body* message;

  void operator()(const groom::Body::Ellipsoid& ellipsoid) const {
    FromVector(ellipsoid.radii, message->mutable_ellipsoid()->mutable_radii_m());
  }
  void operator()(const groom::Body::Capsule& capsule) const {
    FromVector(capsule.a, message->mutable_capsule()->mutable_a());
    FromVector(capsule.b, message->mutable_capsule()->mutable_b());
    message->mutable_capsule()->set_radius_m(capsule.radius);
  }
  void operator()(const std::shared_ptr<const groom::Body::Mesh>& /*mesh*/) const {
    message->mutable_mesh();
  }
};

v1::BodySummary::Shape ShapeKind(const groom::Body& body) {
  if (std::holds_alternative<groom::Body::Ellipsoid>(body.shape)) {
    return v1::BodySummary::SHAPE_ELLIPSOID;
  }
  return MeshOf(body) == nullptr ? v1::BodySummary::SHAPE_CAPSULE : v1::BodySummary::SHAPE_MESH;
}

void FromField(const contact::MeshField& field, v1::MeshReport* message) {
  message->set_triangles(static_cast<uint32_t>(field.report().triangles));
  message->set_holes(static_cast<uint32_t>(field.report().holes));
  message->set_inverted(field.report().inverted);
  message->set_max_error_m(field.max_error());
  message->set_bytes(field.bytes());
}

}  // namespace

Result<groom::Body> ToBody(const v1::Body& message, int index) {
  const std::string path = fmt::format("bodies[{}].", index);
  groom::Body body;
  body.name = message.name();
  switch (message.shape_case()) {
    case v1::Body::kEllipsoid:
      body.shape = groom::Body::Ellipsoid{ToVector(message.ellipsoid().radii_m())};
      break;
    case v1::Body::kCapsule: {
      const v1::CapsuleBody& capsule = message.capsule();
      body.shape =
          groom::Body::Capsule{ToVector(capsule.a()), ToVector(capsule.b()), capsule.radius_m()};
      break;
    }
    case v1::Body::kMesh:
      body.shape = std::make_shared<const groom::Body::Mesh>();
      break;
    case v1::Body::SHAPE_NOT_SET:
      return InvalidArgument(path + "shape",
                             path + "shape is unset; it must be an ellipsoid, a capsule or a mesh");
  }
  const auto friction = ToFriction(message, path);
  if (!friction) return friction.error();
  body.friction = *friction;
  body.moving = message.moving();
  body.pose.p = ToVector(message.pose().position());
  if (message.pose().has_orientation()) body.pose.q = ToQuaternion(message.pose().orientation());
  return groom::MakeBody(std::move(body), index);
}

Result<void> AppendBodyMesh(const v1::TriangleMesh& piece, int index, groom::Body::Mesh* mesh) {
  const std::string path = fmt::format("bodies[{}].mesh.", index);
  if (!piece.hair_triangles().empty()) {
    return InvalidArgument(path + "hair_triangles",
                           path + "hair_triangles must be empty; hair grows on the scalp only");
  }
  if (auto ok = AppendBytes(piece.vertices(), path + "vertices", &mesh->vertices); !ok) return ok;
  return AppendBytes(piece.triangles(), path + "triangles", &mesh->triangles);
}

Result<groom::Body> ToWholeBody(const v1::Body& message, int index) {
  auto body = ToBody(message, index);
  if (!body || !message.has_mesh()) return body;
  auto mesh = std::make_shared<groom::Body::Mesh>();
  if (auto ok = AppendBodyMesh(message.mesh(), index, mesh.get()); !ok) return ok.error();
  body->shape = std::shared_ptr<const groom::Body::Mesh>(std::move(mesh));
  return body;
}

void FromBody(const groom::Body& body, v1::Body* message) {
  message->set_name(body.name);
  std::visit(ShapeWriter{message}, body.shape);
  FromFriction(body.friction, message);
  message->set_moving(body.moving);
  FromPose(body.pose, message->mutable_pose());
}

const groom::Body::Mesh* MeshOf(const groom::Body& body) {
  const auto* mesh = std::get_if<std::shared_ptr<const groom::Body::Mesh>>(&body.shape);
  return mesh == nullptr ? nullptr : mesh->get();
}

void FromBodyMesh(const groom::Body::Mesh& mesh, size_t begin, size_t count,
                  v1::TriangleMesh* message) {
  FromEntries(mesh.vertices, begin, count, message->mutable_vertices());
  FromEntries(mesh.triangles, begin, count, message->mutable_triangles());
}

void FromWholeBody(const groom::Body& body, v1::Body* message) {
  FromBody(body, message);
  const groom::Body::Mesh* mesh = MeshOf(body);
  if (mesh == nullptr) return;
  FromBodyMesh(*mesh, 0, std::numeric_limits<size_t>::max(), message->mutable_mesh());
}

Result<groom::Friction> ToScalpFriction(const v1::ScalpContact& message) {
  const std::string path = "header.scalp_contact.";
  auto friction = ToFriction(message, path);
  if (!friction) return friction;
  if (auto ok = groom::ValidateFriction(path, *friction); !ok) return ok.error();
  return friction;
}

void FromScalpFriction(const groom::Friction& friction, v1::ScalpContact* message) {
  FromFriction(friction, message);
}

StoredContact DescribeContact(const groom::Parts& parts, const head::Bodies* bodies) {
  StoredContact contact;
  if (bodies == nullptr) return contact;
  auto made = bodies->bodies.begin();
  if (parts.scalp_friction) {
    FromScalpFriction(*parts.scalp_friction, contact.mutable_scalp_contact());
    if (const auto* field = head::FieldOf(*made++)) {
      FromField(*field, contact.mutable_scalp_contact()->mutable_mesh());
    }
  }
  for (const groom::Body& body : parts.bodies) {
    v1::BodySummary* summary = contact.add_bodies();
    summary->set_name(body.name);
    summary->set_shape(ShapeKind(body));
    summary->set_moving(body.moving);
    if (const auto* field = head::FieldOf(*made++)) FromField(*field, summary->mutable_mesh());
  }
  return contact;
}

}  // namespace mane::rpc
