#include "groom/scalp_hull.h"

#include <fmt/format.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <iterator>
#include <limits>
#include <vector>

namespace mane::groom {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Of a hull, as of a scalp that is an ellipsoid [m]: hairs lie within what a groom's can be from
// their guides (groom::kOffsetUnitRange).
constexpr double kLargestRadius = 10;

// What of a mesh the hull encloses.
std::vector<Vector3f> HeadOf(const TriangleMesh& mesh) {
  if (mesh.hair_triangles.empty()) return mesh.vertices;
  Eigen::AlignedBox3f hair;
  std::vector<Vector3f> points;
  for (const uint32_t triangle : mesh.hair_triangles) {
    for (const uint32_t corner : mesh.triangles[triangle]) {
      hair.extend(mesh.vertices[corner]);
      points.push_back(mesh.vertices[corner]);
    }
  }
  hair.min().y() = hair.center().y();
  hair.max().y() = std::numeric_limits<float>::infinity();
  std::ranges::copy_if(mesh.vertices, std::back_inserter(points),
                       [&hair](const Vector3f& vertex) { return hair.contains(vertex); });
  return points;
}

}  // namespace

Result<beam::Hull> ScalpHull(const Scalp& scalp) {
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&scalp)) {
    return beam::Hull{ellipsoid->center, ellipsoid->radii};
  }
  auto hull = beam::FitHull(HeadOf(std::get<TriangleMesh>(scalp)));
  if (!hull) return Error{hull.error().code, hull.error().message, "scalp_mesh"};
  const Vector3d& radii = hull->radii;
  if (radii.maxCoeff() <= kLargestRadius) return hull;
  return InvalidArgument("scalp_mesh",
                         fmt::format("scalp_mesh has a hull of radii ({:.6g}, {:.6g}, {:.6g}) m; "
                                     "each must be at most {} m",
                                     radii.x(), radii.y(), radii.z(), kLargestRadius));
}

}  // namespace mane::groom
