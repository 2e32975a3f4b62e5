#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/cancelled.h"
#include "base/result.h"
#include "beam/style.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "groom/import.h"
#include "styling/hairstyle.h"

namespace mane::styling {

/// Hair bent as beams ([AUK92]): some of it guides, all of it members that ride on them.
struct BeamHairstyle {
  std::vector<groom::ImportedStrand> guides;  ///< By part.
  std::vector<uint32_t> first_member = {0};   ///< Of each guide, and the total, (guides + 1).
  /// Every hair, in the order of their guides: nodes. Node k of one rides where node k of its guide
  /// is; none has more nodes than its guide.
  Members members;
  std::vector<Hsv> colours;  ///< Dark brown, as bright as its ambient factor, (members).
};

/// Applies a style by beams to a head.
///
/// Guides: pores of each part are divided among as many cells (FarthestPointCells) as its share of
/// `guide_count` by hairs, at least one; together they are no more than that, or than parts. Of
/// each cell the hair of most nodes, of those the longest, is the guide; its hairs ride on it.
///
/// On a mesh a hair begins with one more point: the skin, on the line from its pore to the
/// center of its hull (groom::ScalpHull), at least 1 mm below the pore; as much where there is no
/// skin. The hull is larger than the head, by a centimetre or two in places. Hair that is tied
/// begins where it is tied.
///
/// @param style        valid (beam::ValidateBeamStyle). @param guide_count  at least 1.
/// @param scalp        valid and not empty.
/// @param field        path of the style, for errors that show only here.
/// @return the same bits for any number of workers. Errors of groom::ScalpHull and
/// beam::ApplyBeamStyle;
///         CANCELLED, or anything, soon after `cancelled` says so.
[[nodiscard]] Result<BeamHairstyle> MakeBeamHairstyle(const beam::BeamStyle& style, int guide_count,
                                                      const groom::Scalp& scalp,
                                                      const std::string& field,
                                                      exec::WorkerPool& pool,
                                                      const base::Cancelled& cancelled = {});

}  // namespace mane::styling
