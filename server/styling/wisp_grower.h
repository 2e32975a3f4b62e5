#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <span>
#include <vector>

#include "math/random.h"
#include "styling/distribution.h"
#include "styling/hairstyle.h"
#include "styling/keep_out.h"

namespace mane::styling {

/// Grows the members of one wisp after the other, joint by joint (members.h, which tells the laws).
/// Scratch for one thread; allocates while it meets larger wisps only.
class WispGrower {
 public:
  WispGrower(const Masters& masters, const Obstacles& obstacles, const Quantile& length,
             std::span<const double> radii, double fuzziness, uint64_t seed);

  /// Members of `wisp`, whose numbers are first, first + 1, ...: member i gets counts[i] points,
  /// from points[i * joints of the master] on.
  void Grow(int wisp, uint32_t first, std::span<const Eigen::Vector3f> roots,
            std::span<Eigen::Vector3f> points, std::span<uint32_t> counts);

 private:
  // One member, up to the last joint that it has reached.
  struct Strand {
    Eigen::Vector3f d;      // Displacement in the joint's frame [m].
    Eigen::Vector3f point;  // Proposed for the next joint.
    float radius;           // Bound of |d|: r_k, at the root max(r_1, |d_1|).
    float step = 0;         // Length of the last segment.
    double length = 0;      // Of the polyline up to here.
    double target;          // Length in the end.
    int number;             // In the wisp.
    math::RandomStream random;
  };

  void Start(uint32_t first, std::span<const Eigen::Vector3f> roots);
  // (W14), (W15): displacements at joint k.
  void Propose(int k);
  // Shortens displacements that lead into obstacles.
  void StayOutside(int k);
  // Takes the proposed point as point k; true where the strand ends there.
  bool Advance(int k, Strand& strand, std::span<Eigen::Vector3f> own, uint32_t& count);
  // The last point, which makes the length exact; returns how many points there are.
  uint32_t Finish(int k, const Strand& strand, std::span<Eigen::Vector3f> own);

  [[nodiscard]] float Radius(int k) const;
  [[nodiscard]] int joints() const { return static_cast<int>(points_.size()); }

  const Masters& masters_;
  const Quantile& length_;
  const std::span<const double> radii_;
  const float fuzziness_;
  const uint64_t seed_;
  KeepOut keep_out_;

  // Of the wisp at hand.
  std::span<const Eigen::Vector3f> points_;  // p^M
  std::span<const Eigen::Quaternionf> frames_;
  double own_joints_ = 0;  // The master's own length, in segments.
  std::vector<Strand> strands_;
  std::vector<Eigen::Vector3f> proposed_;
  std::vector<float> distance_;
};

}  // namespace mane::styling
