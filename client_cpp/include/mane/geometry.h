#pragma once

#include <cstdint>
#include <vector>

namespace mane::inline client {

/// A point or a vector. Right-handed axes, Y up, SI units.
struct Vector3 {
  double x = 0;
  double y = 0;
  double z = 0;
};

/// A rotation as a unit quaternion; takes coordinates of the named frame to its parent's. The
/// server normalises a norm within 1 % of one and refuses anything else.
struct Quaternion {
  double x = 0;
  double y = 0;
  double z = 0;
  double w = 1;
};

/// Placement of a frame in its parent: parent = orientation * local + position.
struct Pose {
  Vector3 position;  ///< [m], each component within ±1e6.
  Quaternion orientation;
};

/// Triangles in the frame of the head, or of a body.
struct TriangleMesh {
  std::vector<float> vertices;           ///< [m], (vertex, 3).
  std::vector<std::uint32_t> triangles;  ///< Indices, (triangle, 3), counter-clockwise outside.
  std::vector<std::uint32_t> hair_triangles;  ///< Where hair grows; empty means everywhere.
};

}  // namespace mane::inline client
