#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "beam/bend_batch.h"
#include "beam/pores.h"
#include "beam/style.h"

/// What ApplyBeamStyle works with: its parts as they are planned, its hairs as they are made.
namespace mane::beam {

/// A cut and where its document has it.
struct NamedCut {
  const Cut* cut;
  std::string field;
};

/// A part, ready to be styled.
struct Plan {
  const Part* part;
  int index;
  Pores pores;
  std::vector<const Force*> forces;  ///< Of the style, then its own.
  std::vector<NamedCut> cuts;        ///< Likewise.
  std::unique_ptr<BendBatch<float>> batch;
  int first_hair;
  int first_block;
  size_t first_node;  ///< Of all that its hairs have before they are cut.
};

/// What becomes of hairs, each written by the piece that styles it.
struct MadeHairs {
  std::vector<Eigen::Vector3f> nodes;  ///< Before cutting, k + 1 of each.
  std::vector<Polar> pores;
  std::vector<int> kept;        ///< Nodes.
  std::vector<uint8_t> cut_by;  ///< Which of the part's cuts ended it; 0 where none did.
  std::vector<uint8_t> sunk;    ///< Whether its root is inside.
  std::vector<float> ambient;
};

/// INVALID_ARGUMENT for what does not fit the head, once all hairs are made (ApplyBeamStyle).
///
/// @param prefix       of the style's fields.
/// @param shared_cuts  how many of every part's cuts, the first, are the style's.
[[nodiscard]] Result<void> CheckFit(std::span<const Plan> plans, const MadeHairs& hairs,
                                    const std::string& prefix, size_t shared_cuts);

}  // namespace mane::beam
