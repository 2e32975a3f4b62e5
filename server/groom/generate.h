#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/result.h"
#include "groom/groom.h"
#include "groom/limits.h"
#include "math/random.h"

namespace mane::groom {

/// Guides to make from a preset: mane.v1.GuideGeneration, whose comments give meanings and ranges.
struct Generation {
  HairType hair_type = HairType::kCustom;  ///< Must be set to a preset.
  uint32_t guide_count = 0;
  double length_m = 0;
  uint32_t element_count = 0;                         ///< 0 for ElementCountFor(error_target).
  std::optional<double> error_target = std::nullopt;  ///< Only where element_count is 0.
  uint64_t seed = 0;
  double curl_variation = 0.05;  ///< Standard deviation, relative; see CurlVariation.
  double root_droop = 0.3;
  /// Where absent, kWound where rod::IsWound says so of hair of even curl. Guides whose own curl
  /// varies too much for that are plain all the same.
  std::optional<StrandModel> model = std::nullopt;
  double wisp_radius_m = 0;  ///< Of every guide.
};

/// Guides of one preset on `scalp`: roots by SampleScalp, frames by RootFrame with a uniform random
/// phase, so that curls start in all directions, element lengths by rod::GradedLengths and natural
/// curvatures by CurlVariation. Guide i
/// draws from stream i of the seed. Same arguments, same bits.
///
/// @param scalp  any; it is validated here.
/// @return `guide_count` guides that MakeGuide accepts. INVALID_ARGUMENT or RESOURCE_EXHAUSTED
/// names
///         a field under `header.generate`, or one of the scalp (ValidateScalp).
[[nodiscard]] Result<std::vector<Guide>> Generate(const Scalp& scalp, const Generation& generation,
                                                  const Limits& limits);

/// Material frame at a root. n0 is `normal` turned toward the ground (-Y) by droop * 90 degrees *
/// the sine of its angle from the vertical: along the surface and downward for droop 1 on the side
/// of a head, and never into it; unchanged where the scalp is level. `phase` [rad] turns n1 and n2
/// about n0.
///
/// @param normal  unit, outward.
/// @param droop   in [0, 1].
[[nodiscard]] Eigen::Quaterniond RootFrame(const Eigen::Vector3d& normal, double droop,
                                           double phase);

/// Natural (twist, curvature 1, curvature 2) [rad/m] of the elements of one guide, of given lengths
/// [m], around `mean` ([SH06] 4.2: small random variations along each strand).
///
/// Adds relative * mean twist * f_0(s) to the twist and relative * mean curvature 1 * f_1(s),
/// f_2(s) to the curvatures, where each f is a sum of three cosines of random phase and frequency,
/// at most two periods along the strand: smooth, of mean 0, variance 1, and never above sqrt(6) in
/// size. Taken at the middle of each element. Straight hair stays straight.
[[nodiscard]] std::vector<Eigen::Vector3d> CurlVariation(const Eigen::Vector3d& mean,
                                                         double relative,
                                                         std::span<const double> lengths,
                                                         math::RandomStream& random);

}  // namespace mane::groom
