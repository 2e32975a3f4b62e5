#pragma once

#include <vector>

#include "contact/mesh.h"

struct RTCDeviceTy;  // Embree's.
struct RTCSceneTy;

namespace mane::contact {

/// Triangles in a hierarchy of Embree's, for sources that ask it; owns its device.
class EmbreeScene {
 public:
  /// @param vertices  float32 numbers [m], so that Embree's boxes hold them.
  EmbreeScene(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  [[nodiscard]] RTCSceneTy* scene() const { return scene_; }
  [[nodiscard]] double reach() const { return reach_; }  ///< Largest coordinate [m].

 private:
  double reach_ = 0;
  RTCDeviceTy* device_;
  RTCSceneTy* scene_;
};

}  // namespace mane::contact
