#include "head/memory.h"

#include <algorithm>

#include "beam/motion_layout.h"
#include "contact/batch_contact.h"
#include "head/beams.h"

namespace mane::head {

BodyCount CountBodies(const groom::Groom& groom) {
  const bool scalp = groom.scalp_friction.has_value();
  const auto moving =
      static_cast<int>(std::ranges::count_if(groom.bodies, [](const auto& b) { return b.moving; }));
  const int bodies = static_cast<int>(groom.bodies.size()) + (scalp ? 1 : 0);
  return {bodies, moving + (bodies > moving ? 1 : 0)};  // All that are fixed are one.
}

size_t StateBytes(const groom::Groom& groom) {
  size_t rows = groom.batch.state_rows();
  if (groom.has_contact) {
    const auto groups = static_cast<size_t>(CountBodies(groom).groups);
    for (const auto& block : groom.batch.blocks()) {
      rows += contact::MemoryRows(contact::FirstPoints(groom.batch, block).back(), groups);
    }
  }
  return rows * sizeof(rod::Row<float>);
}

size_t BeamBytes(const groom::Groom& groom, const BeamOptions& options) {
  // State, as it is and at rest, and constants, in blocks; directions and places guide by guide.
  constexpr size_t kRows =
      2 * beam::layout::kAcrossState + size_t{beam::layout::kConstantsPerSegment};
  const auto guides = static_cast<size_t>(groom.guide_count()),
             k = static_cast<size_t>(SegmentsOf(groom, options));
  const size_t blocks = (guides + simd::kLanes - 1) / simd::kLanes;
  return k * (blocks * kRows * sizeof(rod::Row<float>) +
              guides * (sizeof(Eigen::Vector3d) + sizeof(double)));
}

}  // namespace mane::head
