#pragma once

#include "contact/wisp_approach.h"

namespace mane::contact {

/// Sets piece.contacts to those of guides [begin, end) with later ones: where neighbours' links
/// come nearer than their radii, each the nearest that the other's guide has for it (H3). By first
/// guide, second guide, first point, second point.
///
/// @param neighbours  in: of this step; its pairs' slack is brought up to it.
void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, WispNeighbours& neighbours, WispScratch::Piece& piece);

}  // namespace mane::contact
