#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <vector>

namespace mane::contact {

using Triangle = std::array<uint32_t, 3>;  ///< Vertex indices.

/// Triangles as a caller gives them: any numbers may be in it. Counter-clockwise seen from outside.
struct TriangleMesh {
  std::vector<Eigen::Vector3f> vertices;  ///< [m]
  std::vector<Triangle> triangles;
};

/// Which meshes are taken.
struct MeshLimits {
  int max_vertices = 500'000;     ///< 16 bytes each while a field is built.
  int max_triangles = 1'000'000;  ///< Some hundred bytes each while a field is built.
  double max_coordinate = 1000;   ///< [m], for float32 to resolve 0.1 mm there.
  double max_extent = 100;        ///< Longest side of the bounding box [m].
  /// Area of all holes over the area given. Holes are closed by cones to their centroids: a head
  /// cut at the neck has 0.08, a bust 0.15, a hemisphere 0.5.
  double max_hole_share = 0.2;
};

/// What was found in a mesh, and what was done about it.
struct MeshReport {
  int vertices = 0;              ///< As given.
  int triangles = 0;             ///< As given.
  int welded_vertices = 0;       ///< Joined to an earlier one within 1e-6 of the extent.
  int degenerate_triangles = 0;  ///< Dropped: without area.
  int duplicate_triangles = 0;   ///< Dropped: twice the same, or two that face each other.
  int holes = 0;                 ///< Closed, each by a cone.
  double hole_area = 0;          ///< [m^2]
  double surface_area = 0;       ///< Of the triangles kept, without the holes [m^2].
  double volume = 0;             ///< Enclosed, overlaps as often as they are [m^3].
  bool inverted = false;         ///< Every triangle faced inwards and was turned.
  int buried_triangles = 0;      ///< Within the solid, so that no distance is measured to them.
};

/// A mesh without boundary and with positive volume, as Repair leaves it.
struct SolidMesh {
  std::vector<Eigen::Vector3d> vertices;  ///< [m], each a float32 number.
  std::vector<Triangle> triangles;        ///< Counter-clockwise seen from outside.
};

}  // namespace mane::contact
