#include <fmt/format.h>

#include <algorithm>

#include "beam/style_plan.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;

template <typename T>
std::span<const T> OfPart(const std::vector<T>& hairs, const Plan& plan) {
  return std::span(hairs).subspan(plan.first_hair, plan.part->count);
}

// Whether cut `c` of these parts' is about any of their hairs.
Result<void> CheckRegion(std::span<const Plan> plans, const MadeHairs& hairs, size_t c) {
  const NamedCut& cut = plans.front().cuts[c];
  for (const Plan& plan : plans) {
    const auto grows = [&](const Polar& pore) { return Contains(cut.cut->pores, pore); };
    if (std::ranges::any_of(OfPart(hairs.pores, plan), grows)) return {};
  }
  const std::string path = cut.field + ".pores";
  return InvalidArgument(path, fmt::format("{} is a region where no hair grows", path));
}

// The last cut that ended a hair of a part.
uint8_t LastCut(const Plan& plan, const MadeHairs& hairs) {
  return std::ranges::max(OfPart(hairs.cut_by, plan));
}

Error NothingLeft(const Plan& plan, const MadeHairs& hairs) {
  const std::string& path = plan.cuts[LastCut(plan, hairs)].field;
  return InvalidArgument(path, fmt::format("{} leaves no hair", path));
}

}  // namespace

Result<void> CheckFit(std::span<const Plan> plans, const MadeHairs& hairs,
                      const std::string& prefix, size_t shared_cuts) {
  for (const Plan& plan : plans) {
    if (std::ranges::count(OfPart(hairs.sunk, plan), 1) == 0) continue;
    const Vector3d& at = *plan.part->tied_at;
    const std::string path = fmt::format("{}parts[{}].tied_at", prefix, plan.index);
    return InvalidArgument(
        path, fmt::format("{} is ({}, {}, {}) m; the disc of radius {} m about it must lie outside "
                          "the hull",
                          path, at.x(), at.y(), at.z(), plan.part->tied_radius));
  }
  for (size_t c = 0; c < shared_cuts; ++c) {
    if (const auto ok = CheckRegion(plans, hairs, c); !ok) return ok;
  }
  bool any = false;
  for (const Plan& plan : plans) {
    for (size_t c = shared_cuts; c < plan.cuts.size(); ++c) {
      if (const auto ok = CheckRegion({&plan, 1}, hairs, c); !ok) return ok;
    }
    const bool is_left =
        std::ranges::any_of(OfPart(hairs.kept, plan), [](int kept) { return kept > 0; });
    any = any || is_left;
    if (!is_left && LastCut(plan, hairs) >= shared_cuts) return NothingLeft(plan, hairs);
  }
  return any ? Result<void>() : NothingLeft(plans.back(), hairs);
}

}  // namespace mane::beam
