#pragma once

#include <vector>

#include "contact/wisp_approach.h"

namespace mane::contact {

/// Leaves room for some more, so that a list need not grow in every step that finds a few more.
template <typename T>
void KeepRoom(std::vector<T>& list) {
  if (5 * list.size() > 4 * list.capacity()) list.reserve(2 * list.size());
}

/// Sets piece.contacts to those of guides [begin, end) with later ones: where neighbours' links
/// come nearer than their radii, each the nearest that the other's guide has for it (H3). By first
/// guide, second guide, first point, second point.
///
/// @param neighbours  in: of this step; its pairs' slack is brought up to it.
void FindContacts(const WispPoints& points, const WispStep& step, const WispScratch& scratch,
                  int begin, int end, WispNeighbours& neighbours, WispScratch::Piece& piece);

}  // namespace mane::contact
