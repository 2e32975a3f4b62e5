#include "styling/wisp_segment.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mane::styling {
namespace {

using Eigen::Vector3f;

constexpr int kMostAlong = 8;         // Points along a segment.
constexpr int kAround = 4;            // Around its end.
constexpr float kRing = 0.70710678f;  // By the wisp's radius: half of a full tube lies within.

// A wisp that is denser than tau alone collides with others, not with nobody: its rho_Delta counts
// as this much of tau at most. No turn would help it otherwise.
constexpr float kMostAlone = 0.99f;

// Points that a segment occupies: a cell apart along it, its beginning left out, which no turn of
// the joint moves; and around its end where the grid resolves the wisp's radius.
struct Occupied {
  Occupied(const DensityField::Segment& segment, float cell) {
    const Vector3f along = segment.to - segment.from;
    const float length = along.norm();
    along_count = std::clamp(static_cast<int>(std::ceil(length / cell)), 1, kMostAlong);
    for (int i = 0; i < along_count; ++i) {
      const float share = static_cast<float>(i + 1) / static_cast<float>(along_count);
      point[count++] = segment.from + share * along;
    }
    if (segment.radius <= cell / 2) return;
    const Vector3f u = along.unitOrthogonal() * (kRing * segment.radius);
    const Vector3f v = along.cross(u) / length;
    for (const Vector3f& offset : {u, Vector3f(-u), v, Vector3f(-v)}) {
      point[count++] = segment.to + offset;
    }
  }
  std::array<Vector3f, kMostAlong + kAround> point;
  size_t count = 0;
  int along_count = 0;
};

}  // namespace

Crowding CrowdingTest::Of(const DensityField::Segment& next, float scale) const {
  const Occupied occupied(next, density.box().cell);
  const float most = kMostAlone * tau;
  Crowding worst{-std::numeric_limits<float>::max(), Vector3f::Zero()};
  for (size_t i = 0; i < occupied.count; ++i) {
    DensityField::Stencil at = density.Look(occupied.point[i]);
    // The solid counts where the wisp's axis is: its skin lies against the head.
    const float solid_share = i < static_cast<size_t>(occupied.along_count) ? 1 : 0;
    const float solid = solid_share * at.Value(at.solid);
    // The kernel adds `scale` at most: mostly nothing more need be known.
    const float bound =
        hair_share * at.Value(at.hair) + std::min(hair_share * scale, most) + solid - tau;
    if (bound <= 0 || bound <= worst.excess) {
      if (bound > worst.excess) worst = {bound, Vector3f::Zero()};
      continue;
    }
    std::array<float, 8> part, added;
    density.Increase(next, scale, at, &added);
    for (const Laid& laid : own) {
      density.Increase(laid.segment, laid.scale, at, &part);
      for (size_t k = 0; k < 8; ++k) at.hair[k] -= part[k];
    }
    const float excess =
        hair_share * at.Value(at.hair) + std::min(hair_share * at.Value(added), most) + solid - tau;
    if (excess <= worst.excess) continue;
    worst = {excess, hair_share * at.Slope(at.hair) + solid_share * at.Slope(at.solid)};
  }
  return worst;
}

}  // namespace mane::styling
