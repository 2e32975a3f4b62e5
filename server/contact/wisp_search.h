#pragma once

#include <span>

#include "contact/wisp_approach.h"

namespace mane::contact {

/// Finds the contacts of guides [begin, end) with later ones: where neighbours' links
/// come nearer than their radii, and nearer than the links beside them (H3). By first guide, second
/// guide, first point, second point.
///
/// @param neighbours  in: of this step; its pairs' slack is brought up to it.
/// @return  this thread's list, which the next call overwrites.
[[nodiscard]] std::span<const WispScratch::Contact> FindContacts(const WispPoints& points,
                                                                 const WispStep& step,
                                                                 const WispScratch& scratch,
                                                                 int begin, int end,
                                                                 WispNeighbours& neighbours);

}  // namespace mane::contact
