#include "contact/embree_scene.h"

#include <embree3/rtcore.h>

#include <algorithm>

#include "base/check.h"

namespace mane::contact {

EmbreeScene::EmbreeScene(const std::vector<Eigen::Vector3d>& vertices,
                         const std::vector<Triangle>& triangles) {
  device_ = rtcNewDevice(nullptr);  // Without a number of threads: it would limit all of oneTBB's.
  MANE_CHECK(device_ != nullptr);
  scene_ = rtcNewScene(device_);
  rtcSetSceneFlags(scene_, RTC_SCENE_FLAG_ROBUST);
  const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* corners = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), vertices.size()));
  auto* indices = static_cast<uint32_t*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(Triangle), triangles.size()));
  MANE_CHECK(corners != nullptr && indices != nullptr);
  for (const Eigen::Vector3d& v : vertices) {
    for (const double x : v) *corners++ = static_cast<float>(x);
    reach_ = std::max(reach_, v.lpNorm<Eigen::Infinity>());
  }
  for (const Triangle& t : triangles) indices = std::copy(t.begin(), t.end(), indices);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene_, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene_);
  MANE_CHECK(rtcGetDeviceError(device_) == RTC_ERROR_NONE);
}

EmbreeScene::~EmbreeScene() {
  rtcReleaseScene(scene_);
  rtcReleaseDevice(device_);
}

}  // namespace mane::contact
