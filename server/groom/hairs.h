#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "base/result.h"
#include "groom/limits.h"
#include "groom/range.h"
#include "wire/assemble_hair.h"

namespace mane::groom {

/// Control points of one hair.
inline constexpr int kMinHairPoints = 2;
inline constexpr int kMaxHairPoints = 1000;
/// Of Hairs::offset_unit: offsets of 33 um to 33 m.
inline constexpr Range kOffsetUnitRange{1e-9, 1e-3, "m"};

/// The hairs of a groom, which ride on its guides: mane.v1.HairBatch, all of them in flat arrays.
/// wire/assemble_hair.h says where their points are. 14 bytes a hair, 8 a point.
struct Hairs {
  double offset_unit = 0;                       ///< Of the places' offsets [m].
  std::vector<uint32_t> guides;                 ///< That each rides on, not decreasing, (hairs).
  std::vector<uint32_t> first_point = {0};      ///< Of each in `places`; the end, (hairs + 1).
  std::vector<wire::HairPlace> places;          ///< Root first, (points).
  std::vector<std::array<uint8_t, 3>> colours;  ///< sRGB, (hairs); empty for none.

  [[nodiscard]] size_t count() const { return guides.size(); }
  [[nodiscard]] std::span<const wire::HairPlace> places_of(size_t hair) const {
    return std::span(places).subspan(first_point[hair], first_point[hair + 1] - first_point[hair]);
  }
  bool operator==(const Hairs&) const = default;
};

/// Whether there are no more hairs and points than `limits` allow. RESOURCE_EXHAUSTED naming
/// `hairs`.
[[nodiscard]] Result<void> CheckHairCounts(size_t hairs, size_t points, const Limits& limits);

/// Whether `hairs` may ride on `guide_count` guides.
///
/// @return RESOURCE_EXHAUSTED above `limits`; INVALID_ARGUMENT for the first that is wrong of
///   `header.hair_offset_unit_m`; `hairs` where lists do not fit each other; `hairs[i].guide` where
///   there is no such guide, or it is less than that of the hair before; `hairs[i].point_count`;
///   `hairs[i].places[k]` whose part is less than that of the point before.
[[nodiscard]] Result<void> ValidateHairs(const Hairs& hairs, int guide_count, const Limits& limits);

/// A guide at rest, sampled as frames of it are.
struct GuideAtRest {
  std::span<const Eigen::Vector3f> points;  ///< At equal arc length, head frame [m], at least 2.
  Eigen::Quaternionf root_frame;            ///< Unit, head frame: that of Guide::root.
};

/// A hair at rest.
struct HairAtRest {
  uint32_t guide = 0;
  /// Of the guide's arc length, one a point, each in [0, 1], not decreasing.
  std::span<const float> parts;
  std::span<const Eigen::Vector3f> points;  ///< Control points, head frame [m].
  std::array<uint8_t, 3> colour{};          ///< sRGB.
};

/// `hairs` as they ride on `guides`: wire::AssembleHair of the result on the same samples gives
/// every coordinate back within offset_unit / 2 across the carried axes, and rounding. The unit is
/// the least that holds the largest offset: 32767 of it.
///
/// Parts are rounded to 1/65535 before offsets are found, so that this rounding costs nothing at
/// rest; when the guide bends by kappa more, at most |o| kappa L / 131070.
///
/// @param hairs     by guide, as Hairs::guides; what they say must pass ValidateHairs (checked
///                  there), guides exist and spans be of one size (checked here).
/// @param coloured  whether the result holds colours.
/// Pure; O(points).
[[nodiscard]] Hairs RideOn(std::span<const GuideAtRest> guides, std::span<const HairAtRest> hairs,
                           bool coloured);

}  // namespace mane::groom
