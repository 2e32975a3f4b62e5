#include "groom/hairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace mane::groom {
namespace {

using Eigen::Vector3f;
using wire::HairPlace;

constexpr float kMaxOffset = 32767;

Result<void> ValidateHair(const Hairs& hairs, size_t i, int guide_count) {
  const uint32_t guide = hairs.guides[i], before = i == 0 ? 0 : hairs.guides[i - 1];
  if (guide >= static_cast<uint32_t>(guide_count) || guide < before) {
    const std::string field = fmt::format("hairs[{}].guide", i);
    const std::string why =
        guide < before
            ? fmt::format("hairs are in the order of guides, and the one before is on {}", before)
            : fmt::format("the groom has {} guides", guide_count);
    return InvalidArgument(field, fmt::format("{} is {}; {}", field, guide, why));
  }
  const std::span<const HairPlace> places = hairs.places_of(i);
  if (places.size() < kMinHairPoints || places.size() > kMaxHairPoints) {
    const std::string field = fmt::format("hairs[{}].point_count", i);
    return InvalidArgument(field, fmt::format("{} is {}; it must be between {} and {}", field,
                                              places.size(), kMinHairPoints, kMaxHairPoints));
  }
  const auto fall = std::ranges::is_sorted_until(places, {}, &HairPlace::part);
  if (fall == places.end()) return {};
  const std::string field = fmt::format("hairs[{}].places[{}]", i, fall - places.begin());
  return InvalidArgument(
      field, fmt::format("{} is at part {} of 65535, the point before at {}; parts must not "
                         "decrease from root to tip",
                         field, fall->part, (fall - 1)->part));
}

// Calls visit(part, offset [m]) for every control point in order.
template <typename Visit>
void ForEachOffset(std::span<const GuideAtRest> guides, std::span<const HairAtRest> hairs,
                   const Visit& visit) {
  std::vector<Eigen::Quaternionf> frames;
  wire::CarriedGuide carried;
  for (size_t i = 0; i < hairs.size(); ++i) {
    const HairAtRest& hair = hairs[i];
    MANE_CHECK(hair.guide < guides.size() && hair.parts.size() == hair.points.size());
    if (i == 0 || hair.guide != hairs[i - 1].guide) {
      const GuideAtRest& guide = guides[hair.guide];
      frames.resize(guide.points.size());
      wire::CarryFrames(guide.root_frame, guide.points, frames);
      carried = {guide.points, frames};
    }
    for (size_t k = 0; k < hair.points.size(); ++k) {
      MANE_CHECK(hair.parts[k] >= 0 && hair.parts[k] <= 1);
      const auto part = static_cast<uint16_t>(std::lround(hair.parts[k] * wire::kTipPart));
      visit(part, wire::OffsetOf(carried, part, hair.points[k]));
    }
  }
}

}  // namespace

Result<void> CheckHairCounts(size_t hairs, size_t points, const Limits& limits) {
  const long hair_count = static_cast<long>(hairs), point_count = static_cast<long>(points);
  if (hair_count > limits.max_hairs) return TooMany("hairs", "hairs", hair_count, limits.max_hairs);
  if (point_count > limits.max_hair_points) {
    return TooMany("hairs", "control points", point_count, limits.max_hair_points);
  }
  return {};
}

Result<void> ValidateHairs(const Hairs& hairs, int guide_count, const Limits& limits) {
  if (auto ok = CheckHairCounts(hairs.count(), hairs.places.size(), limits); !ok) return ok;
  if (!kOffsetUnitRange.Contains(hairs.offset_unit)) {
    return OutOfRange("header.hair_offset_unit_m", hairs.offset_unit, kOffsetUnitRange);
  }
  const std::vector<uint32_t>& first = hairs.first_point;
  if (first.size() != hairs.count() + 1 || first.front() != 0 ||
      first.back() != hairs.places.size() || !std::ranges::is_sorted(first) ||
      (!hairs.colours.empty() && hairs.colours.size() != hairs.count())) {
    return InvalidArgument(
        "hairs", fmt::format("hairs has {} guides, {} first points up to {}, {} places and {} "
                             "colours, which do not fit each other",
                             hairs.count(), first.size(), first.empty() ? 0 : first.back(),
                             hairs.places.size(), hairs.colours.size()));
  }
  for (size_t i = 0; i < hairs.count(); ++i) {
    if (auto ok = ValidateHair(hairs, i, guide_count); !ok) return ok;
  }
  return {};
}

Hairs RideOn(std::span<const GuideAtRest> guides, std::span<const HairAtRest> hairs,
             bool coloured) {
  float largest = 0;
  ForEachOffset(guides, hairs, [&largest](uint16_t, const Vector3f& offset) {
    largest = std::max(largest, offset.cwiseAbs().maxCoeff());
  });
  MANE_CHECK(largest <= kMaxOffset * kOffsetUnitRange.high);
  Hairs result;
  result.offset_unit = std::max(double{largest} / kMaxOffset, kOffsetUnitRange.low);
  const auto in_units = [unit = result.offset_unit](float offset) {
    return static_cast<int16_t>(std::lround(offset / unit));
  };
  for (const HairAtRest& hair : hairs) {
    result.guides.push_back(hair.guide);
    result.first_point.push_back(result.first_point.back() +
                                 static_cast<uint32_t>(hair.points.size()));
    if (coloured) result.colours.push_back(hair.colour);
  }
  result.places.reserve(result.first_point.back());
  ForEachOffset(guides, hairs, [&](uint16_t part, const Vector3f& o) {
    result.places.push_back({part, {in_units(o.x()), in_units(o.y()), in_units(o.z())}});
  });
  return result;
}

}  // namespace mane::groom
