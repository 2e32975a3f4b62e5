#pragma once

#include <embree3/rtcore.h>

#include "contact/mesh.h"

namespace mane::contact {

/// Triangles in a hierarchy of Embree's, for sources that ask it; owns its device.
class EmbreeScene {
 public:
  /// @param vertices  float32 numbers [m], so that Embree's boxes hold them.
  EmbreeScene(const std::vector<Eigen::Vector3d>& vertices, const std::vector<Triangle>& triangles);
  ~EmbreeScene();
  EmbreeScene(const EmbreeScene&) = delete;
  EmbreeScene& operator=(const EmbreeScene&) = delete;

  [[nodiscard]] RTCScene scene() const { return scene_; }
  [[nodiscard]] double reach() const { return reach_; }  ///< Largest coordinate [m].

 private:
  double reach_ = 0;
  RTCDevice device_;
  RTCScene scene_;
};

}  // namespace mane::contact
