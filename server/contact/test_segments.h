#pragma once

#include <Eigen/Core>

#include <algorithm>

namespace mane::contact {

/// What the kernels are held against: a segment from `a` to `b` [m].
struct Segment {
  Eigen::Vector3f a, b;

  [[nodiscard]] Eigen::Vector3f At(float s) const { return a + s * (b - a); }
};

/// Where two segments are closest: at fraction s of the first and t of the second, in [0, 1].
struct ClosestFractions {
  float s = 0, t = 0;
};

/// Closest points of two segments (contact.md, H1). Of parallel ones, which are as close all along,
/// the middle of the stretch that they share; what is almost parallel changes over to it smoothly.
/// Pure; points are allowed.
[[nodiscard]] inline ClosestFractions ClosestPoints(const Segment& p, const Segment& q) {
  constexpr float kParallel = 1e-3f;  // Of sin^2 of the angle between them.
  constexpr float kPoint = 1e-14f;    // Shorter than 0.1 um [m^2].
  const Eigen::Vector3f d = p.b - p.a, e = q.b - q.a, r = p.a - q.a;
  const float dd = d.squaredNorm(), ee = e.squaredNorm(), dr = d.dot(r), er = e.dot(r);
  const auto unit = [](float x) { return std::clamp(x, 0.0f, 1.0f); };
  if (!(dd > kPoint) && !(ee > kPoint)) return {0, 0};
  if (!(dd > kPoint)) return {0, unit(er / ee)};
  if (!(ee > kPoint)) return {unit(-dr / dd), 0};

  const float de = d.dot(e);
  const float middle = 0.5f * (unit(-dr / dd) + unit((de - dr) / dd));
  const float regular = kParallel * dd * ee;
  const float s =
      unit((de * er - dr * ee + regular * middle) / (std::max(0.0f, dd * ee - de * de) + regular));
  const float t = (de * s + er) / ee;
  if (t < 0) return {unit(-dr / dd), 0};
  if (t > 1) return {unit((de - dr) / dd), 1};
  return {s, t};
}

}  // namespace mane::contact
