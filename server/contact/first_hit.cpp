#include "contact/first_hit.h"

#include <embree3/rtcore.h>

#include "base/check.h"
#include "contact/embree_scene.h"

namespace mane::contact {

FirstHit::FirstHit(const std::vector<Eigen::Vector3d>& vertices,
                   const std::vector<Triangle>& triangles) {
  MANE_CHECK(!triangles.empty());
  scene_ = std::make_unique<EmbreeScene>(vertices, triangles);
}

FirstHit::~FirstHit() = default;

std::optional<Eigen::Vector3d> FirstHit::Find(const Eigen::Vector3d& from,
                                              const Eigen::Vector3d& to) const {
  const Eigen::Vector3f origin = from.cast<float>(), way = (to - from).cast<float>();
  RTCRayHit ray{};
  ray.ray.org_x = origin.x(), ray.ray.org_y = origin.y(), ray.ray.org_z = origin.z();
  ray.ray.dir_x = way.x(), ray.ray.dir_y = way.y(), ray.ray.dir_z = way.z();
  ray.ray.tfar = 1;
  ray.ray.mask = ~0U;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene_->scene(), &context, &ray);
  if (ray.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::nullopt;
  return from + static_cast<double>(ray.ray.tfar) * (to - from);
}

}  // namespace mane::contact
