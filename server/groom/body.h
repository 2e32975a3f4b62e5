#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "math/rigid.h"

namespace mane::groom {

/// How hair rubs on a body: contact::Friction.
struct Friction {
  double coefficient = 0.3;  ///< [0, 10].
  double anisotropy = 0.25;  ///< [0, 1].
};

/// A body that hair meets: head, neck, shoulder, hand, prop. Rigid; what bends is several of these,
/// one a bone.
struct Body {
  /// About the origin, axes along the body's frame.
  struct Ellipsoid {
    Eigen::Vector3d radii;  ///< [m]
  };
  /// All points within `radius` of the segment from `a` to `b` [m].
  struct Capsule {
    Eigen::Vector3d a, b;
    double radius;
  };
  /// Triangles, counter-clockwise seen from outside.
  struct Mesh {
    std::vector<Eigen::Vector3f> vertices;  ///< [m]
    std::vector<std::array<uint32_t, 3>> triangles;
  };

  std::string name;  ///< Unique in its groom.
  std::variant<Ellipsoid, Capsule, std::shared_ptr<const Mesh>> shape;
  Friction friction;
  /// Whether it has poses of its own; else it is fixed to the head.
  bool moving = false;
  /// From the body's frame to the head's; where it moves, for an upright head until it is moved.
  math::Pose pose;
};

}  // namespace mane::groom
