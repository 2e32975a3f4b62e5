#pragma once

#include "contact/wisp_approach.h"

namespace mane::contact {

/// Brings the neighbours of a head's links up to the step (contact.md, H3): measures the links,
/// sets scratch.links, guide_of and guide_mass, and searches anew for those that went too far.
void FindNeighbours(const WispPoints& points, const WispStep& step, const WispSettings& settings,
                    WispScratch& scratch, exec::WorkerPool& pool, WispNeighbours& neighbours);

/// How guide `g` is cut into links.
[[nodiscard]] WispNeighbours::Layout LayOut(const WispPoints& points, size_t g);

/// Sees a guide's points by the frame and measures its links; sets what scratch holds of them.
///
/// @param root_length  WispSettings::root_length.
/// @param scratch  last_place is that of neighbours.place in the last step.
void MeasureLinks(const WispPoints& points, size_t g, const WispStep& step, const WispFrame& frame,
                  float root_length, WispNeighbours& neighbours, WispScratch& scratch);

}  // namespace mane::contact
