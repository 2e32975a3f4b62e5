#include "head/settle.h"

#include <algorithm>
#include <limits>
#include <span>
#include <utility>

#include "head/head.h"

namespace mane::head {
namespace {

constexpr double kTime = 5;      // [s]
constexpr double kDamping = 10;  // Rate at which air stops free hair [1/s]: next to critical.

// Factor on the drag of `groom` that damps so its hair that is damped least.
double DragScale(const groom::Groom& groom) {
  double least = std::numeric_limits<double>::infinity();
  for (const groom::Guide& guide : groom.guides) {
    least = std::min(least, guide.strand.air_drag / guide.strand.linear_density);
  }
  return std::max(1.0, kDamping / std::max(least, 1e-3));
}

}  // namespace

std::vector<rod::Row<float>> Settle(const groom::Groom& groom, std::shared_ptr<const Bodies> bodies,
                                    exec::WorkerPool& pool) {
  HeadState state = AtRest(groom, {});
  if (bodies->bodies.empty()) return std::move(state.guides);
  StartContact(groom, std::move(bodies), &state);
  Environment air;
  air.air_drag_scale = DragScale(groom);
  const int steps = static_cast<int>(kTime / kLongestStep);
  for (int i = 0; i < steps; ++i) {
    Advance(groom, {math::Pose{}, kLongestStep, 1}, air, &state, pool);
  }
  std::vector<double> coordinates = Coordinates(groom, state);
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    const auto own =
        std::span(coordinates)
            .subspan(groom.first_coordinate[guide], groom.guides[guide].coordinate_count());
    groom.batch.SetStill(guide, own, state.guides);
  }
  return std::move(state.guides);
}

}  // namespace mane::head
