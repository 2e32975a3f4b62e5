#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <vector>

#include "groom/groom.h"
#include "math/random.h"
#include "math/weighted_choice.h"

namespace mane::groom {

/// A point of a scalp.
struct ScalpPoint {
  Eigen::Vector3d position;  ///< Head frame [m].
  Eigen::Vector3d normal;    ///< Outward, unit: of the triangle's plane, or of the ellipsoid.
  int triangle = -1;         ///< Index in the mesh; -1 on an ellipsoid.
};

/// Where hair grows, as patches: the hair triangles of a mesh that have an area, or 128 x 128 cells
/// of an ellipsoid's cap. A patch is the image of the unit square, which keeps ratios of areas (on
/// an ellipsoid as far as its curvature is even over a cell: it is, as long as its radii are within
/// a factor of about ten of each other).
///
/// Refers to the scalp that it is made of. Immutable; any thread may read it.
class HairRegion {
 public:
  /// @param scalp  its indices in range. Without one, or without area, there are no patches.
  explicit HairRegion(const Scalp& scalp);

  [[nodiscard]] double area() const { return choice_.total(); }  ///< [m^2]
  [[nodiscard]] int patches() const { return static_cast<int>(areas_.size()); }
  [[nodiscard]] double area_of(int patch) const { return areas_[patch]; }  ///< [m^2]

  /// The point (s, t) of a patch, both in [0, 1]. Lines of constant s and of constant t bound
  /// convex parts of a triangle.
  [[nodiscard]] ScalpPoint At(int patch, double s, double t) const;

  /// A random point, even over the area; draws three numbers. There must be a patch.
  [[nodiscard]] ScalpPoint Draw(math::RandomStream& random) const;

 private:
  void Add(double area);
  void AddTriangle(uint32_t triangle);
  void AddCells();
  [[nodiscard]] Eigen::Vector3d Corner(uint32_t triangle, int k) const;
  [[nodiscard]] ScalpPoint OnTriangle(int patch, double s, double t) const;
  [[nodiscard]] Eigen::Vector3d Normal(int cell, double s, double t) const;

  const TriangleMesh* mesh_ = nullptr;
  const Ellipsoid* ellipsoid_ = nullptr;
  std::vector<uint32_t> triangles_;                             // Of a mesh: the patches.
  Eigen::Quaterniond to_cap_ = Eigen::Quaterniond::Identity();  // Takes +Y to the cap's axis.
  double drop_step_ = 0;                                        // Of an ellipsoid.
  std::vector<double> areas_;
  math::WeightedChoice choice_;
};

}  // namespace mane::groom
