#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "styling/obstacles.h"
#include "styling/style.h"

namespace mane::styling {

/// INVALID_ARGUMENT naming `<field>[1].constraints[0].path[0]` or so, unless there are at most 64
/// queues of 1 to 64 constraints each, a point has a path of one point and the others one of 2 to
/// 4096 points, coordinates lie within ±100 m, neighbours of a path are 1e-6 m apart or more, radii
/// lie in (0, 10] m and weights in [0, 1], and no point of attraction or of a trajectory lies
/// deeper in an obstacle than the constraint's radius.
[[nodiscard]] Result<void> Validate(const std::vector<ConstraintQueue>& queues,
                                    const Obstacles& obstacles, const std::string& field);

/// The same of one constraint, naming `<field>.path[0]` or so.
[[nodiscard]] Result<void> Validate(const Constraint& constraint, const Obstacles& obstacles,
                                    const std::string& field);

/// INVALID_ARGUMENT naming `<field>[i].selection` and telling both queues where a wisp is selected
/// by two. Cost: wisps and what is selected.
///
/// @param selected  wisps of each queue, each below `wisps`.
[[nodiscard]] Result<void> ValidateSelections(const std::vector<ConstraintQueue>& queues,
                                              const std::vector<std::vector<uint32_t>>& selected,
                                              int wisps, const std::string& field);

/// A place on a path.
struct PathPlace {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< [m]
  Eigen::Vector3d tangent = Eigen::Vector3d::Zero();  ///< Unit; zero on a path of one point.
  double arc = 0;                                     ///< From the path's beginning [m].
  double distance = 0;                                ///< Of what is near it [m].
};

/// A polyline by arc length. Immutable, thread-safe.
class Path {
 public:
  /// @param points  one or more, neighbours apart.
  explicit Path(const std::vector<Eigen::Vector3d>& points);

  [[nodiscard]] double length() const { return arcs_.back(); }

  /// The place nearest to `x` from arc `begin` to `end` [m]; the first of several. Looks at the
  /// pieces in between.
  [[nodiscard]] PathPlace Nearest(const Eigen::Vector3d& x, double begin, double end) const;
  [[nodiscard]] PathPlace Nearest(const Eigen::Vector3d& x) const {
    return Nearest(x, 0, length());
  }
  /// Direction at an arc length, which is clamped.
  [[nodiscard]] Eigen::Vector3d TangentAt(double arc) const;

 private:
  [[nodiscard]] size_t PieceAt(double arc) const;

  std::vector<Eigen::Vector3d> points_;
  std::vector<double> arcs_;               // Of the points.
  std::vector<Eigen::Vector3d> tangents_;  // Of the pieces; one zero vector where there is none.
};

/// Psi at `x` (D8): a unit vector, or zero where the constraint says nothing.
///
/// @param place           nearest to x on the path.
/// @param segment_length  of the outline [m].
[[nodiscard]] Eigen::Vector3d Psi(const Constraint& constraint, const Path& path,
                                  const PathPlace& place, const Eigen::Vector3d& x,
                                  double segment_length);

}  // namespace mane::styling
