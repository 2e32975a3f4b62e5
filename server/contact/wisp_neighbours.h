#pragma once

#include "contact/wisp_approach.h"

namespace mane::contact {

/// Brings the neighbours of a head's links up to the step (contact.md, H3): measures the links,
/// sets scratch.links, guide_of and guide_mass, and searches anew where one has left its box.
void FindNeighbours(const WispPoints& points, const WispStep& step, const WispSettings& settings,
                    WispScratch& scratch, exec::WorkerPool& pool, WispNeighbours& neighbours);

}  // namespace mane::contact
