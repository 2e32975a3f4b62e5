#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "styling/obstacles.h"

namespace mane::styling {

/// Keeps points of strands out of obstacles. Has scratch memory: one for each thread.
class KeepOut {
 public:
  explicit KeepOut(const Obstacles& obstacles);

  [[nodiscard]] bool empty() const { return obstacles_.empty(); }

  /// Distances [m], negative inside, in float32: resizes `distance` to `points` and fills it.
  void Distances(std::span<const Eigen::Vector3f> points, std::vector<float>& distance);

  /// Lower bounds of the distances [m]: what lies nearer to the point than that is outside. A
  /// mesh's distance may be three times too large far from it, (W17).
  void Margins(std::span<const Eigen::Vector3f> points, std::vector<float>& margin);

  /// Largest part of `d`, to 1/4096, that leads from `base` to a point outside; 0 where `base` is
  /// itself inside. `base + d` is inside.
  [[nodiscard]] float Shorten(const Eigen::Vector3f& base, const Eigen::Vector3f& d) const;

  /// Turns `tip` about `joint` out of the obstacles, which keeps its distance to it to rounding.
  /// Leaves a rest where `joint` is itself deeper inside than that distance.
  [[nodiscard]] Eigen::Vector3f TurnOut(const Eigen::Vector3f& joint,
                                        const Eigen::Vector3f& tip) const;

 private:
  // Distances to one obstacle, into one_.
  void DistancesTo(const Obstacle& obstacle, std::span<const Eigen::Vector3f> points);

  const Obstacles& obstacles_;
  std::vector<float> x_, y_, z_, one_, nx_, ny_, nz_;
};

}  // namespace mane::styling
