#include "contact/wisp_approach.h"

#include <algorithm>
#include <cmath>

#include "contact/segment_distance.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;
using Contact = WispScratch::Contact;

// First time in [0, dt] at which d + time w is as short as `reach`, or shortest.
float TouchTime(const Vector3f& d, const Vector3f& w, float reach, float dt) {
  const float ww = w.squaredNorm(), dw = d.dot(w), beyond = d.squaredNorm() - reach * reach;
  if (!(beyond > 0) || !(dw < 0) || !(ww * dt * dt > 1e-14f)) return 0;
  const float root = dw * dw - ww * beyond;
  const float time = root > 0 ? beyond / (-dw + std::sqrt(root)) : -dw / ww;
  return std::min(time, dt);
}

}  // namespace

float SumOfRadii(const WispPoints& points, const int32_t guide[2]) {
  const auto radius = [&](int32_t g) {
    return std::min(points.radius[static_cast<size_t>(g)], kLargestRadius);
  };
  return radius(guide[0]) + radius(guide[1]);
}

Contact Approach(const WispPoints& points, const WispStep& step, const int32_t guide[2],
                 const int32_t point[2]) {
  Vector3f start[4], velocity[4];
  for (size_t k = 0; k < 4; ++k) {
    const auto p = static_cast<size_t>(point[k / 2]) + k % 2;
    velocity[k] = points.velocity[p];
    start[k] = points.Position(p) - step.h * velocity[k];
  }
  const auto closest = [&](float time) {
    return ClosestPoints({start[0] + time * velocity[0], start[1] + time * velocity[1]},
                         {start[2] + time * velocity[2], start[3] + time * velocity[3]});
  };
  const auto difference = [](const Vector3f x[4], const ClosestFractions& at) -> Vector3f {
    return x[0] + at.s * (x[1] - x[0]) - x[2] - at.t * (x[3] - x[2]);
  };

  const float reach = SumOfRadii(points, guide);
  ClosestFractions at = closest(0);
  Vector3f d = difference(start, at), w = difference(velocity, at);
  float time = TouchTime(d, w, reach, step.dt);
  if (time * w.norm() > 0.1f * reach) {  // Other places may be closest then.
    at = closest(time);
    d = difference(start, at);
    w = difference(velocity, at);
    time = TouchTime(d, w, reach, step.dt);
  }
  return {{guide[0], guide[1]},
          {point[0], point[1]},
          {at.s, at.t},
          std::sqrt(LeastDistance2(d, w, step.dt)),
          d,
          d + time * w};
}

void Walk(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
          Contact& contact) {
  const int32_t guide[2] = {contact.guide[0], contact.guide[1]};
  const auto go = [&](const int32_t next[2]) {
    const Contact closer = Approach(points, step, guide, next);
    const bool better = closer.distance < contact.distance;
    if (better) contact = closer;
    return better;
  };
  const auto edge = [&](int32_t p) -> Vector3f {
    const auto k = static_cast<size_t>(p);
    return points.Position(k + 1) - points.Position(k);
  };
  for (int tries = 0; tries < 5; ++tries) {
    int32_t next[2];
    for (int k = 0; k < 2; ++k) {
      const float s = contact.fraction[k];
      next[k] = contact.point[k];
      const int way = s >= 1 ? 1 : s <= 0 ? -1 : 0;
      const int32_t p = contact.point[k] + way;
      if (way == 0 || p < 0 || scratch.guide_of[static_cast<size_t>(p)] != guide[k]) continue;
      // Only where the next segment leads nearer to the other.
      const float nearer = (k == 0 ? -1.0f : 1.0f) * contact.approach.dot(edge(p));
      if (static_cast<float>(way) * nearer > 0) next[k] = p;
    }
    const int32_t first[2] = {next[0], contact.point[1]};
    const int32_t second[2] = {contact.point[0], next[1]};
    const bool one = next[0] != contact.point[0], two = next[1] != contact.point[1];
    if (!(one && two && go(next)) && !(one && go(first)) && !(two && go(second))) break;
  }
}

}  // namespace mane::contact
