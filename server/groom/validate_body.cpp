#include "groom/validate_body.h"

#include <fmt/format.h>

#include <set>
#include <string_view>
#include <utility>

#include "base/text.h"
#include "groom/range.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr size_t kMaxName = 63;
// As contact::Validate has them.
constexpr Range kRadiusRange{1e-4, 100, "m"};
constexpr Range kEndRange{-1000, 1000, "m"};

Result<void> CheckName(const std::string& path, const std::string& name) {
  if (base::IsIdentifier(name, kMaxName, "-_")) return {};
  const std::string field = path + "name";
  return InvalidArgument(field, fmt::format("{} is \"{}\"; it must be 1 to {} of a-z, 0-9, - and "
                                            "_, and begin and end with a letter or digit",
                                            field, base::Shown(name), kMaxName));
}

Result<void> CheckRatio(const std::string& field, const Vector3d& radii) {
  const double ratio = radii.maxCoeff() / radii.minCoeff();
  if (ratio <= kLargestRadiusRatio) return {};
  return InvalidArgument(
      field, fmt::format("{} is ({}, {}, {}) m; the largest may be at most {} times the smallest",
                         field, radii.x(), radii.y(), radii.z(), kLargestRadiusRatio));
}

struct CheckShape {
  const std::string& path;

  Result<void> operator()(const Body::Ellipsoid& ellipsoid) const {
    const std::string field = path + "ellipsoid.radii_m";
    if (auto radii = CheckVector(field, ellipsoid.radii, kRadiusRange); !radii) return radii;
    return CheckRatio(field, ellipsoid.radii);
  }
  Result<void> operator()(const Body::Capsule& capsule) const {
    if (auto a = CheckVector(path + "capsule.a", capsule.a, kEndRange); !a) return a;
    if (auto b = CheckVector(path + "capsule.b", capsule.b, kEndRange); !b) return b;
    if (kRadiusRange.Contains(capsule.radius)) return {};
    return OutOfRange(path + "capsule.radius_m", capsule.radius, kRadiusRange);
  }
  Result<void> operator()(const std::shared_ptr<const Body::Mesh>& /*mesh*/) const { return {}; }
};

Result<void> CheckSizes(std::span<const Body> bodies, const Limits& limits) {
  if (std::ssize(bodies) > limits.max_bodies) {
    return TooMany("bodies", "bodies", std::ssize(bodies), limits.max_bodies);
  }
  long vertices = 0, triangles = 0;
  for (size_t i = 0; i < bodies.size(); ++i) {
    const auto* mesh = std::get_if<std::shared_ptr<const Body::Mesh>>(&bodies[i].shape);
    if (mesh == nullptr) continue;
    vertices += std::ssize((*mesh)->vertices);
    triangles += std::ssize((*mesh)->triangles);
    const std::string path = fmt::format("bodies[{}].mesh.", i);
    if (vertices > limits.max_body_vertices) {
      return TooMany(path + "vertices", "vertices", vertices, limits.max_body_vertices);
    }
    if (triangles > limits.max_body_triangles) {
      return TooMany(path + "triangles", "triangles", triangles, limits.max_body_triangles);
    }
  }
  return {};
}

Result<void> CheckScalpContact(const Friction& friction, const Scalp& scalp) {
  const std::string field = "header.scalp_contact";
  if (std::holds_alternative<std::monostate>(scalp)) {
    return InvalidArgument(
        field, field + " is set, but there is no scalp: send header.ellipsoid or scalp_mesh");
  }
  if (auto ok = ValidateFriction(field + ".", friction); !ok) return ok;
  const auto* ellipsoid = std::get_if<Ellipsoid>(&scalp);
  return ellipsoid == nullptr ? Result<void>()
                              : CheckRatio("header.ellipsoid.radii_m", ellipsoid->radii);
}

}  // namespace

Result<void> ValidateFriction(const std::string& path, const Friction& friction) {
  const Range coefficient{0, 10}, anisotropy{0, 1};
  if (!coefficient.Contains(friction.coefficient)) {
    return OutOfRange(path + "friction", friction.coefficient, coefficient);
  }
  if (anisotropy.Contains(friction.anisotropy)) return {};
  return OutOfRange(path + "friction_anisotropy", friction.anisotropy, anisotropy);
}

Result<Body> MakeBody(Body body, int index) {
  const std::string path = fmt::format("bodies[{}].", index);
  if (auto name = CheckName(path, body.name); !name) return name.error();
  if (auto shape = std::visit(CheckShape{path}, body.shape); !shape) return shape.error();
  if (auto ok = ValidateFriction(path, body.friction); !ok) return ok.error();
  if (auto p = CheckVector(path + "pose.position", body.pose.p, kCoordinateRange); !p) {
    return p.error();
  }
  auto q = UnitQuaternion(path + "pose.orientation", body.pose.q);
  if (!q) return q.error();
  body.pose.q = *q;
  return body;
}

Result<void> ValidateBodies(std::span<const Body> bodies,
                            const std::optional<Friction>& scalp_friction, const Scalp& scalp,
                            const Limits& limits) {
  if (auto sizes = CheckSizes(bodies, limits); !sizes) return sizes;
  std::set<std::string_view> names;
  for (size_t i = 0; i < bodies.size(); ++i) {
    if (names.insert(bodies[i].name).second) continue;
    const std::string field = fmt::format("bodies[{}].name", i);
    return InvalidArgument(field, fmt::format("{} is \"{}\", as that of another body; names must "
                                              "be unique in a groom",
                                              field, bodies[i].name));
  }
  return scalp_friction ? CheckScalpContact(*scalp_friction, scalp) : Result<void>();
}

}  // namespace mane::groom
