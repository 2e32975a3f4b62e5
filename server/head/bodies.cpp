#include "head/bodies.h"

#include <fmt/format.h>

#include <set>
#include <type_traits>
#include <utility>

#include "head/settle.h"
#include "head/wisps.h"

namespace mane::head {
namespace {

constexpr const char* kScalp = "the scalp that hair meets";
// As the variant of groom::Body::shape numbers them.
constexpr const char* kShapes[] = {"ellipsoid", "capsule", "mesh"};

contact::Friction FrictionOf(const groom::Friction& friction) {
  return {friction.coefficient, friction.anisotropy};
}

Error Within(const std::string& path, const std::string& whose, Error error) {
  error.field = path + error.field;
  error.message = whose + ": " + error.message;
  return error;
}

template <typename Mesh>
Result<contact::BodyShape> MakeField(const Mesh& mesh, contact::FieldCache* fields,
                                     const base::Cancelled& cancelled) {
  auto field = fields->Get({mesh.vertices, mesh.triangles}, cancelled);
  if (!field) return field.error();
  return contact::BodyShape(*std::move(field));
}

struct ShapeOf {
  contact::FieldCache* fields;
  const base::Cancelled& cancelled;

  Result<contact::BodyShape> operator()(const groom::Body::Ellipsoid& ellipsoid) const {
    return contact::BodyShape(contact::Ellipsoid(ellipsoid.radii));
  }
  Result<contact::BodyShape> operator()(const groom::Body::Capsule& capsule) const {
    return contact::BodyShape(contact::Capsule(capsule.a, capsule.b, capsule.radius));
  }
  Result<contact::BodyShape> operator()(
      const std::shared_ptr<const groom::Body::Mesh>& mesh) const {
    return MakeField(*mesh, fields, cancelled);
  }
};

// The scalp as a body fixed to the head.
Result<Bodies::Body> ScalpBody(const groom::Groom& groom, contact::FieldCache* fields,
                               const base::Cancelled& cancelled) {
  const contact::Friction friction = FrictionOf(*groom.scalp_friction);
  if (const auto* mesh = std::get_if<groom::TriangleMesh>(&groom.scalp)) {
    auto field = MakeField(*mesh, fields, cancelled);
    if (!field) return Within("scalp_mesh.", kScalp, field.error());
    return Bodies::Body{*std::move(field), friction, {}};
  }
  if (const auto* ellipsoid = std::get_if<groom::Ellipsoid>(&groom.scalp)) {
    math::Pose pose;
    pose.p = ellipsoid->center;
    return Bodies::Body{contact::Ellipsoid(ellipsoid->radii), friction, pose};
  }
  return Error{ErrorCode::kInvalidArgument, "the groom has no scalp that hair could meet",
               "header.scalp_contact"};
}

std::vector<Bodies::Group> GroupsOf(const std::vector<Bodies::Body>& bodies) {
  std::vector<Bodies::Group> groups;
  Bodies::Group fixed;
  for (const Bodies::Body& body : bodies) {
    if (body.moving >= 0) continue;
    fixed.bodies.bodies.push_back({body.shape, {body.pose, body.pose, 0}});
    fixed.bodies.frictions.push_back(body.friction);
  }
  if (!fixed.bodies.bodies.empty()) groups.push_back(std::move(fixed));
  for (const Bodies::Body& body : bodies) {
    if (body.moving < 0) continue;
    groups.push_back({{{{body.shape, {}}}, {body.friction}}, body.moving});
  }
  return groups;
}

}  // namespace

Result<std::shared_ptr<Bodies>> MakeShapes(const groom::Groom& groom, contact::FieldCache* fields,
                                           const base::Cancelled& cancelled) {
  if (groom.bodies.empty() && !groom.scalp_friction) return std::shared_ptr<Bodies>();
  auto made = std::make_shared<Bodies>();
  if (groom.scalp_friction) {
    auto scalp = ScalpBody(groom, fields, cancelled);
    if (!scalp) return scalp.error();
    if (auto valid = contact::Validate(scalp->shape); !valid) {
      return Within("header.ellipsoid.", kScalp, valid.error());
    }
    made->bodies.push_back(*std::move(scalp));
  }
  for (size_t i = 0; i < groom.bodies.size(); ++i) {
    const groom::Body& body = groom.bodies[i];
    const std::string path = fmt::format("bodies[{}].{}.", i, kShapes[body.shape.index()]);
    const std::string whose = fmt::format("body \"{}\"", body.name);
    auto shape = std::visit(ShapeOf{fields, cancelled}, body.shape);
    if (!shape) return Within(path, whose, shape.error());
    if (auto valid = contact::Validate(*shape); !valid) return Within(path, whose, valid.error());
    made->bodies.push_back({*std::move(shape), FrictionOf(body.friction), body.pose,
                            body.moving ? made->moving_count++ : -1});
    if (const size_t bytes = FieldBytes(made->bodies); bytes > kMaxFieldBytes) {
      return Error{ErrorCode::kResourceExhausted,
                   fmt::format("{} brings the distance fields of the groom's meshes to {} bytes; "
                               "at most {} are allowed: use coarser or fewer meshes",
                               whose, bytes, kMaxFieldBytes),
                   fmt::format("bodies[{}].mesh", i)};
    }
  }
  made->groups = GroupsOf(made->bodies);
  return made;
}

Result<std::shared_ptr<const Bodies>> MakeBodies(const groom::Groom& groom,
                                                 contact::FieldCache* fields,
                                                 exec::WorkerPool& pool,
                                                 const base::Cancelled& cancelled) {
  auto made = MakeShapes(groom, fields, cancelled);
  if (!made) return made.error();
  if (*made == nullptr && !HasWisps(groom)) return std::shared_ptr<const Bodies>();
  if (*made == nullptr) *made = std::make_shared<Bodies>();
  if (auto settled = Settle(groom, *made, pool, cancelled); !settled) return settled.error();
  if (HasWisps(groom)) (*made)->wisps = MakeWisps(groom, **made, pool);
  return std::shared_ptr<const Bodies>(*std::move(made));
}

const contact::MeshField* FieldOf(const Bodies::Body& body) {
  const auto* field = std::get_if<std::shared_ptr<const contact::MeshField>>(&body.shape);
  return field == nullptr ? nullptr : field->get();
}

size_t FieldBytes(std::span<const Bodies::Body> bodies) {
  std::set<const contact::MeshField*> fields;
  for (const Bodies::Body& body : bodies) fields.insert(FieldOf(body));
  fields.erase(nullptr);
  size_t bytes = 0;
  for (const contact::MeshField* field : fields) bytes += field->bytes();
  return bytes;
}

std::vector<math::Pose> BodiesAtRest(const Bodies& bodies, const math::Pose& head) {
  std::vector<math::Pose> poses;
  for (const Bodies::Body& body : bodies.bodies) {
    if (body.moving >= 0) poses.push_back(head * body.pose);
  }
  return poses;
}

}  // namespace mane::head
