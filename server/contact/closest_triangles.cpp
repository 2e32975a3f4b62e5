#include "contact/closest_triangles.h"

#include <embree3/rtcore.h>

#include <cmath>
#include <limits>

#include "base/check.h"
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
  explicit Scene(const SolidMesh& solid) {
    prepared.reserve(solid.triangles.size());
    for (const auto& [a, b, c] : solid.triangles) {
      prepared.emplace_back(solid.vertices[a], solid.vertices[b], solid.vertices[c]);
    }
    device = rtcNewDevice(nullptr);  // Without a number of threads: it would limit all of oneTBB's.
    MANE_CHECK(device != nullptr);
    scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                3 * sizeof(float), solid.vertices.size()));
    auto* triangles = static_cast<uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                sizeof(Triangle), solid.triangles.size()));
    MANE_CHECK(vertices != nullptr && triangles != nullptr);
    for (const Vector3d& v : solid.vertices) {
      for (const double x : v) *vertices++ = static_cast<float>(x);
      reach = std::max(reach, v.lpNorm<Eigen::Infinity>());
    }
    for (const Triangle& t : solid.triangles) triangles = std::copy(t.begin(), t.end(), triangles);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene);
    MANE_CHECK(rtcGetDeviceError(device) == RTC_ERROR_NONE);
  }
  ~Scene() {
    rtcReleaseScene(scene);
    rtcReleaseDevice(device);
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  std::vector<PreparedTriangle> prepared;
  double reach = 0;  // Largest coordinate [m].
  RTCDevice device;
  RTCScene scene;
};

ClosestTriangles::ClosestTriangles(const SolidMesh& mesh) {
  MANE_CHECK(!mesh.triangles.empty());
  scene_ = std::make_unique<Scene>(mesh);
}

ClosestTriangles::~ClosestTriangles() = default;

ClosestTriangles::Hit ClosestTriangles::Find(const Vector3d& point, double within) const {
  const double reach = std::max(scene_->reach, point.lpNorm<Eigen::Infinity>());
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
    rtcPointQuery(scene_->scene, &query, &context, Visit, &search);
    // What was found beyond the radius need not be the nearest.
    if (std::sqrt(search.squared) <= radius * (1 + 1e-9)) break;
  }
  SearchBudget::Count(search.work);
  MANE_CHECK(search.triangle != RTC_INVALID_GEOMETRY_ID);
  return {std::sqrt(search.squared), search.nearest, static_cast<int>(search.triangle)};
}

}  // namespace mane::contact
