#include "contact/closest_triangles.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "contact/embree_scene.h"
#include "contact/search_budget.h"
#include "contact/triangle.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

// What a search and a triangle that it looks at take [ns].
constexpr uint64_t kSearchWork = 250, kVisitWork = 8;

struct Search {
  const std::vector<PreparedTriangle>& triangles;
  const Vector3d& point;
  double slack;  // What float32 may lose of a distance here [m].
  double squared = std::numeric_limits<double>::infinity();
  Vector3d nearest = Vector3d::Zero();
  uint32_t triangle = RTC_INVALID_GEOMETRY_ID;
  uint64_t work = kSearchWork;
};

// Looks at one triangle that Embree found near enough.
bool Visit(RTCPointQueryFunctionArguments* arguments) {
  auto& search = *static_cast<Search*>(arguments->userPtr);
  const PreparedTriangle& triangle = search.triangles[arguments->primID];
  search.work += kVisitWork;
  // Not even its plane is near enough, rounding granted.
  const double above = triangle.n.dot(search.point - triangle.a);
  if (above * above > search.squared * (1 + 1e-9) + 1e-24) return false;
  const Vector3d nearest = ClosestOnTriangle(search.point, triangle);
  const double squared = (nearest - search.point).squaredNorm();
  if (squared > search.squared) return false;
  if (squared == search.squared && arguments->primID > search.triangle) return false;
  search.squared = squared;
  search.nearest = nearest;
  search.triangle = arguments->primID;
  const auto radius = static_cast<float>(std::sqrt(squared) * (1 + 1e-6) + search.slack);
  if (radius >= arguments->query->radius) return false;
  arguments->query->radius = radius;
  return true;
}

}  // namespace

struct ClosestTriangles::Scene {
  explicit Scene(const SolidMesh& solid) : embree(solid.vertices, solid.triangles) {
    prepared.reserve(solid.triangles.size());
    for (const auto& [a, b, c] : solid.triangles) {
      prepared.emplace_back(solid.vertices[a], solid.vertices[b], solid.vertices[c]);
    }
  }

  EmbreeScene embree;
  std::vector<PreparedTriangle> prepared;
};

ClosestTriangles::ClosestTriangles(const SolidMesh& mesh) {
  MANE_CHECK(!mesh.triangles.empty());
  scene_ = std::make_unique<Scene>(mesh);
}

ClosestTriangles::~ClosestTriangles() = default;

ClosestTriangles::Hit ClosestTriangles::Find(const Vector3d& point, double within) const {
  const double reach = std::max(scene_->embree.reach(), point.lpNorm<Eigen::Infinity>());
  Search search{scene_->prepared, point, 1e-6 * reach};
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  const double unlimited = 8 * reach;
  for (const double radius : {std::min(within, unlimited), unlimited}) {
    RTCPointQuery query;
    query.x = static_cast<float>(point.x());
    query.y = static_cast<float>(point.y());
    query.z = static_cast<float>(point.z());
    query.time = 0;
    query.radius = static_cast<float>(radius * (1 + 1e-6) + search.slack);
    rtcPointQuery(scene_->embree.scene(), &query, &context, Visit, &search);
    // What was found beyond the radius need not be the nearest.
    if (std::sqrt(search.squared) <= radius * (1 + 1e-9)) break;
  }
  SearchBudget::Count(search.work);
  MANE_CHECK(search.triangle != RTC_INVALID_GEOMETRY_ID);
  return {std::sqrt(search.squared), search.nearest, static_cast<int>(search.triangle)};
}

}  // namespace mane::contact
