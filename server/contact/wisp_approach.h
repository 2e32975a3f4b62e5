#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "contact/wisp_pairs.h"
#include "simd/rows.h"

namespace mane::contact {

inline constexpr float kLargestRadius = 0.1f;  ///< A wisp counts as no wider [m].
/// Wisps farther apart than their radii by this part of the sum are no pair.
inline constexpr float kMargin = 0.25f;

inline constexpr float kUnknown = -1;  ///< Slack of what has to be looked at [m].

/// Leaves room for some more than a list has, so that it need not grow in every step that finds a
/// few more.
template <typename T>
void KeepRoom(std::vector<T>& list) {
  const size_t size = std::max<size_t>(list.size(), 64);
  if (5 * size > 4 * list.capacity()) list.reserve(2 * size);
}

/// Rows that the kernels take (wisp_layout.h).
using SegmentPairRows = std::array<simd::Row<float>, kSegmentPairRows>;

/// Sets three rows of a lane.
inline void Put(const Eigen::Vector3f& v, size_t row, size_t lane, SegmentPairRows& rows) {
  for (int k = 0; k < 3; ++k) rows[row++].lane[lane] = v[k];
}

/// Of two guides' wisps [m].
[[nodiscard]] float SumOfRadii(const WispPoints& points, const int32_t guide[2]);

/// Finds where the segments of each contact, contact.guide and contact.point, come closest within
/// the step: when they first touch at the sum of their radii, or are nearest (contact.md, H2).
void FindApproaches(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                    std::span<WispScratch::Contact> contacts);

/// Memory of walks; grows to what it has seen and is reused.
struct WalkScratch {
  std::vector<int32_t> walking;            ///< Which contacts have just gone on,
  std::vector<WispScratch::Contact> next;  ///< where they might go,
  std::vector<int32_t> next_of;            ///< and which of them.
};

/// Where two segments touch at an end, goes on to the next ones along the guides as long as those
/// are closer.
void Walk(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
          std::span<WispScratch::Contact> contacts, WalkScratch& walk);

}  // namespace mane::contact
