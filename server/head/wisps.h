#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/bodies.h"
#include "head/contact.h"
#include "rod/batch.h"

namespace mane::head {

/// Whether any guide stands for a wisp that others meet.
[[nodiscard]] bool HasWisps(const groom::Groom& groom);

/// The wisps of `groom` as they lie in the shape of bodies.settled.
[[nodiscard]] Wisps MakeWisps(const groom::Groom& groom, const Bodies& bodies,
                              exec::WorkerPool& pool);

/// What drives one step of a head whose wisps meet.
struct WispStep {
  using Drive = std::array<rod::Row<float>, rod::layout::kDriveRows>;
  std::span<const Drive> drives;  ///< Of every block, or one for all.
  std::span<const contact::GroupMotion> motions;
  double surprise;  ///< BatchContact::surprise.
  double dt;        ///< [s]
};

/// Advances all blocks, which are at full detail, by one step: among bodies, among each other, and
/// pressed apart where they are denser than at rest.
///
/// @param failed  out: as rod::StepBlock returns, (blocks).
/// @param bends   out: BlockStep::Bend() of all strands, (blocks).
void StepAmongWisps(const groom::Groom& groom, const WispStep& step,
                    std::span<rod::Row<float>> guides, Contact* contact, exec::WorkerPool& pool,
                    std::vector<uint32_t>* failed, std::vector<float>* bends);

}  // namespace mane::head
