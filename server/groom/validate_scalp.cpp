#include <fmt/format.h>

#include <numbers>
#include <string>

#include "groom/range.h"
#include "groom/sampler.h"
#include "groom/validate.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr double kMinHairArea = 1e-10;  // m^2

Result<void> CheckIndices(const TriangleMesh& mesh) {
  const size_t vertices = mesh.vertices.size();
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const uint32_t v : mesh.triangles[t]) {
      if (v < vertices) continue;
      const std::string field = fmt::format("scalp_mesh.triangles[{}]", t);
      return InvalidArgument(
          field, fmt::format("{} names vertex {}; the mesh has {}", field, v, vertices));
    }
  }
  std::vector<bool> named(mesh.triangles.size(), false);
  for (size_t i = 0; i < mesh.hair_triangles.size(); ++i) {
    const uint32_t t = mesh.hair_triangles[i];
    if (t < named.size() && !named[t]) {
      named[t] = true;
      continue;
    }
    const std::string field = fmt::format("scalp_mesh.hair_triangles[{}]", i);
    return InvalidArgument(
        field, t < named.size()
                   ? fmt::format("{} names triangle {} a second time", field, t)
                   : fmt::format("{} names triangle {}; the mesh has {}", field, t, named.size()));
  }
  return {};
}

Result<void> CheckArea(const std::string& field, const Scalp& scalp) {
  const double area = HairArea(scalp);
  if (area >= kMinHairArea) return {};
  return InvalidArgument(
      field, fmt::format("{} leaves a hair region of {} m^2; it must have {} m^2", field, area,
                         kMinHairArea));
}

Result<void> ValidateMesh(const Scalp& scalp, const Limits& limits) {
  const TriangleMesh& mesh = std::get<TriangleMesh>(scalp);
  if (std::ssize(mesh.vertices) > limits.max_vertices) {
    return TooMany("scalp_mesh.vertices", "vertices", std::ssize(mesh.vertices),
                   limits.max_vertices);
  }
  if (std::ssize(mesh.triangles) > limits.max_triangles) {
    return TooMany("scalp_mesh.triangles", "triangles", std::ssize(mesh.triangles),
                   limits.max_triangles);
  }
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vector3d vertex = mesh.vertices[i].cast<double>();
    if ((vertex.array().abs() <= kCoordinateRange.high).all()) continue;  // False for NaN.
    return CheckVector(fmt::format("scalp_mesh.vertices[{}]", i), vertex, kCoordinateRange);
  }
  if (mesh.triangles.empty()) {
    return InvalidArgument("scalp_mesh.triangles",
                           "scalp_mesh.triangles is empty; a scalp needs at least one triangle");
  }
  if (auto indices = CheckIndices(mesh); !indices) return indices;
  return CheckArea(
      mesh.hair_triangles.empty() ? "scalp_mesh.triangles" : "scalp_mesh.hair_triangles", scalp);
}

Result<void> ValidateEllipsoid(const Scalp& scalp) {
  const std::string path = "header.ellipsoid.";
  const Ellipsoid& ellipsoid = std::get<Ellipsoid>(scalp);
  if (auto center = CheckVector(path + "center", ellipsoid.center, kCoordinateRange); !center) {
    return center;
  }
  if (auto radii = CheckVector(path + "radii_m", ellipsoid.radii, {1e-3, 10, "m"}); !radii) {
    return radii;
  }
  const double axis_length = ellipsoid.cap_axis.norm();
  if (!(axis_length >= 1e-6 && axis_length <= 1e6)) {
    return InvalidArgument(path + "cap_axis",
                           fmt::format("{}cap_axis is ({}, {}, {}) of length {}; the length must "
                                       "lie in [1e-06, 1e+06]",
                                       path, ellipsoid.cap_axis.x(), ellipsoid.cap_axis.y(),
                                       ellipsoid.cap_axis.z(), axis_length));
  }
  const Range angle_range{0, std::numbers::pi, "rad", true};
  if (!angle_range.Contains(ellipsoid.cap_angle)) {
    return OutOfRange(path + "cap_angle", ellipsoid.cap_angle, angle_range);
  }
  return CheckArea(path + "cap_angle", scalp);
}

}  // namespace

Result<void> ValidateScalp(const Scalp& scalp, const Limits& limits) {
  if (std::holds_alternative<TriangleMesh>(scalp)) return ValidateMesh(scalp, limits);
  if (std::holds_alternative<Ellipsoid>(scalp)) return ValidateEllipsoid(scalp);
  return {};
}

}  // namespace mane::groom
