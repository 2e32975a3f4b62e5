#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "styling/obstacles.h"

namespace mane::styling {

/// Keeps the points of a wisp out of obstacles. Has scratch memory: one for each thread.
///
/// Use: Follow a master, then for a joint Gather the obstacles near it, then ask about points that
/// are within the given reach of it: only those obstacles count.
class KeepOut {
 public:
  explicit KeepOut(const Obstacles& obstacles);

  /// Takes the distances of a master's points to all obstacles.
  void Follow(std::span<const Eigen::Vector3f> master);

  /// Collects the obstacles that may lie within `reach` [m] of the master's point k; false if none.
  /// A mesh's distance may be three times too large far from it, (W17).
  [[nodiscard]] bool Gather(int k, float reach);

  /// Distances to the gathered [m], negative inside, in float32: resizes `distance` to `points`.
  void Distances(std::span<const Eigen::Vector3f> points, std::vector<float>& distance);

  /// A large part of `d` that leads from `base` to a point outside and at most 1e-5 m from the
  /// surface (in hard cases, 1e-3 of `d` short of it); 0 where `base` is itself inside. `distance`
  /// is that of `base + d`, < 0.
  [[nodiscard]] float Shorten(const Eigen::Vector3f& base, const Eigen::Vector3f& d,
                              float distance) const;

  /// Turns `tip` about `joint` out of the gathered, which keeps its distance to it to rounding;
  /// where turning does not lead out, shortens what leads there instead.
  [[nodiscard]] Eigen::Vector3f TurnOut(const Eigen::Vector3f& joint,
                                        const Eigen::Vector3f& tip) const;

 private:
  // Obstacles as kernels want them.
  struct Placed {
    const contact::BodyShape* shape;
    math::Pose to_shape;
    bool mesh;
    std::vector<float> margin;  // About each point of the master nothing of it lies within.
  };

  // Distances of `points` into one_.
  void DistancesTo(const Placed& placed, std::span<const Eigen::Vector3f> points);
  [[nodiscard]] contact::Distance At(const Eigen::Vector3d& point) const;

  std::vector<Placed> placed_;
  std::vector<int> near_;
  std::vector<float> x_, y_, z_, one_, nx_, ny_, nz_;
};

}  // namespace mane::styling
