#pragma once

#include <span>
#include <vector>

#include "groom/groom.h"
#include "groom/hairs.h"
#include "groom/import.h"
#include "styling/hairstyle.h"

namespace mane::styling {

/// Points a guide is sampled at for its members: what a client that assembles hairs does best to
/// ask for (`points_per_guide`). Other numbers move hairs by as much as their splines differ.
inline constexpr int kGuideSamples = 64;

/// Master strands as strands to import: their control points, as far as the master's own length. A
/// master of less than two segments has its last segment cut.
[[nodiscard]] std::vector<groom::ImportedStrand> ToStrands(const Masters& masters);

/// Members as hairs of the guides that strands became.
///
/// A member's control point k rides where its strand's point k is on the guide; beyond the strand,
/// at the tip. Upright and at rest the hairs are where the members are, whatever the fit of the
/// guides was, to quantisation.
///
/// @param strands       such as ToStrands(masters), each with a length.
/// @param first_member  of each strand, and the total, (strands + 1).
/// @param colours       (members).
/// @param guides        of `strands`, plain ones, in order. @param rest  their rest shapes, as
///                      groom::Import::rest.
[[nodiscard]] groom::Hairs ToHairs(std::span<const groom::ImportedStrand> strands,
                                   std::span<const uint32_t> first_member, const Members& members,
                                   std::span<const Hsv> colours,
                                   std::span<const groom::Guide> guides,
                                   std::span<const double> rest);

}  // namespace mane::styling
