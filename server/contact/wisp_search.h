#pragma once

#include "contact/wisp_pairs.h"

namespace mane::contact {

/// The step in which wisps are searched.
struct WispStep {
  float dt;  ///< [s]
  float h;   ///< kTheta dt: positions are extrapolated by it [s].
};

/// Of two guides' wisps [m]; each counts 0.1 m at most.
[[nodiscard]] float SumOfRadii(const WispPoints& points, const int32_t guide[2]);

/// Two segments of different guides within a step (contact.md, H2): where they are closest when
/// they first touch at the sum of their radii, or come closest.
[[nodiscard]] WispScratch::Contact Approach(const WispPoints& points, const WispStep& step,
                                            const int32_t guide[2], const int32_t point[2]);

/// Sets scratch.boxes, middles and grid: what each segment may meet within the step.
void BuildGrid(const WispPoints& points, const WispStep& step, const WispSettings& settings,
               WispScratch& scratch, exec::WorkerPool& pool);

/// Sets piece.contacts to those of guides [begin, end) with later ones: segments that come nearer
/// than their radii, and whose middles are each the nearest that the other's guide has for it, or
/// the next ones along the guides where those are closer (H3). By first guide, second guide, first
/// point, second point.
void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, WispScratch::Piece& piece);

/// Wisps farther apart than their radii by this part of the sum are no pair.
inline constexpr float kMargin = 0.25f;

}  // namespace mane::contact
