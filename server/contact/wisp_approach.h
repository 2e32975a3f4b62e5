#pragma once

#include <algorithm>

#include "contact/wisp_pairs.h"

namespace mane::contact {

inline constexpr float kLargestRadius = 0.1f;  ///< A wisp counts as no wider [m].
/// Wisps farther apart than their radii by this part of the sum are no pair.
inline constexpr float kMargin = 0.25f;

inline constexpr float kUnknown = -1;  ///< Slack of what has to be looked at [m].

/// Of two guides' wisps [m].
[[nodiscard]] float SumOfRadii(const WispPoints& points, const int32_t guide[2]);

/// Least squared length of d + time w within [0, dt].
[[nodiscard]] inline float LeastDistance2(const Eigen::Vector3f& d, const Eigen::Vector3f& w,
                                          float dt) {
  const float dw = d.dot(w), ww = w.squaredNorm();
  const float time = std::clamp(-dw / std::max(ww, 1e-20f), 0.0f, dt);
  return (d + time * w).squaredNorm();
}

/// Two segments of different guides within a step (contact.md, H2): where they are closest when
/// they first touch at the sum of their radii, or come closest.
[[nodiscard]] WispScratch::Contact Approach(const WispPoints& points, const WispStep& step,
                                            const int32_t guide[2], const int32_t point[2]);

/// Where two segments touch at an end, goes on to the next ones along the guides as long as those
/// are closer.
void Walk(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
          WispScratch::Contact& contact);

}  // namespace mane::contact
