#pragma once

#include <span>
#include <utility>

#include "contact/wisp_pairs.h"

namespace mane::contact {

inline constexpr int kPairsAPiece = 256;    ///< One worker's at a time,
inline constexpr int kPointsAPiece = 1024;  ///< and points.

/// Lists the pairs' ends by segment: scratch.first_end and ends.
///
/// @param points  their number.
void ListEnds(std::span<const WispPair> pairs, size_t points, WispScratch& scratch);

/// Calls visit(index of the pair, side) for the pairs of a guide.
template <typename Visit>
void ForPairsOf(size_t guide, const WispScratch& scratch, const Visit& visit) {
  const auto first = static_cast<size_t>(scratch.first_point[guide]);
  const auto last = static_cast<size_t>(scratch.first_point[guide + 1]);
  for (int32_t e = scratch.first_end[first]; e < scratch.first_end[last]; ++e) {
    const WispScratch::End& at = scratch.ends[static_cast<size_t>(e)];
    visit(static_cast<size_t>(at.pair), at.side);
  }
}

/// Shares out what pairs give to the ends of the segments that they act on: calls store(point, sum)
/// for the points [begin, end), with the sum of part(pair, side) by how near it is, in one order
/// always.
template <typename Sum, typename Part, typename Store>
void SumAtPoints(int begin, int end, std::span<const WispPair> pairs, const WispScratch& scratch,
                 const Sum& zero, const Part& part, const Store& store) {
  Sum sum = zero, next = zero;  // Of a segment's first point, and of its last.
  for (auto p = static_cast<size_t>(begin - (begin > 0)); p < static_cast<size_t>(end); ++p) {
    for (int32_t e = scratch.first_end[p]; e < scratch.first_end[p + 1]; ++e) {
      const WispScratch::End& at = scratch.ends[static_cast<size_t>(e)];
      const WispPair& pair = pairs[static_cast<size_t>(at.pair)];
      const float s = pair.fraction[at.side];
      const Sum whole = part(pair, at.side);
      sum += (1 - s) * whole;
      next += s * whole;
    }
    if (p >= static_cast<size_t>(begin)) store(p, sum);
    sum = std::exchange(next, zero);
  }
}

/// Sums the pairs' impulses at points [begin, end) (H13).
void SpreadImpulses(int begin, int end, std::span<const WispPair> pairs, const WispScratch& scratch,
                    const ImpulseSpans& impulses);

/// The same, at all points.
void SpreadImpulses(std::span<const WispPair> pairs, const WispScratch& scratch,
                    exec::WorkerPool& pool, const ImpulseSpans& impulses);

}  // namespace mane::contact
