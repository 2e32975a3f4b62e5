#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "mane/geometry.h"

namespace mane::inline client {

enum class HairType;

/// Section, material and damping of hair; ranges and meanings as in Guide. What is unset is taken
/// from where the member of this type says.
struct HairProperties {
  std::optional<double> radius_1_m = {};
  std::optional<double> radius_2_m = {};
  std::optional<double> young_modulus_pa = {};
  std::optional<double> poisson_ratio = {};
  std::optional<double> density_kg_m3 = {};
  std::optional<double> internal_friction = {};
  std::optional<double> air_drag = {};
};

/// One strand of another program: a polyline along the hair as it looks at rest, under gravity and
/// on an upright head. It becomes one guide.
struct ImportedStrand {
  /// Head frame, root first [m], (k, 3); k from 2 to 1000, usually 25 to 100, at any spacing.
  std::vector<float> points = {};
  /// Material frame at the root, as in Guide; unset lets it follow the points.
  std::optional<Quaternion> root_frame = {};
  HairProperties properties = {};  ///< What is unset is that of ImportOptions.
};

/// How strands become guides: a fit by helical elements, then natural curvatures with which the
/// fitted shape is at rest under its weight.
struct ImportOptions {
  HairType hair_type{};            ///< Required: section, material and damping; not its curl.
  HairProperties properties = {};  ///< What is unset is that of `hair_type`.
  /// Helical elements of every strand, 1 to 64; with a bound, the most that one may have. 0: 20.
  std::uint32_t element_count = 0;
  /// Largest distance allowed of a point from the fitted strand [m], in (0, 1]: every strand gets
  /// the fewest elements that keep within it; one that cannot is reported. 0: none.
  double error_bound_m = 1e-3;
  std::optional<double> noise_m = {};  ///< Of the points' coordinates [m]; unset: estimated.
  bool hold = true;  ///< False takes the fitted shapes for the natural ones; they then sag.
  /// Hair too soft for its shape buckles; its Young's modulus is raised by the least factor that
  /// holds it, at most this one, 1 to 1000.
  double max_stiffness_factor = 4;
  double stability_margin = 0.1;  ///< How far from buckling a held shape must be, 0 to 0.9.
  double wisp_radius_m = 0;       ///< Of all guides, as in Guide.
};

/// Strands to import, in place of guides.
struct StrandImport {
  std::vector<ImportedStrand> strands = {};
  ImportOptions options = {};
};

/// What an import did, over all strands.
struct ImportSummary {
  std::uint32_t strand_count = 0;
  std::uint64_t point_count = 0;
  double largest_fit_distance_m = 0;     ///< Of a given point from the fitted strand.
  double rms_fit_distance_m = 0;         ///< Over all points.
  std::uint32_t bound_missed_count = 0;  ///< Strands that miss `error_bound_m`.
  std::uint32_t not_held_count = 0;      ///< Strands whose shape does not hold.
  /// Largest distance of a tip, at rest after a small push, from where it was fitted.
  double largest_tip_deviation_m = 0;
  double largest_stiffness_factor = 1;  ///< That was applied.
};

/// An import strand by strand; every list is (strand), in the order of the guides.
struct ImportReport {
  ImportSummary summary = {};
  std::vector<std::uint32_t> element_counts = {};
  std::vector<float> largest_fit_distances = {};  ///< [m]
  std::vector<float> rms_fit_distances = {};      ///< [m]
  std::vector<std::uint8_t> bounds_met = {};  ///< 1 where within the bound, or without one; else 0.
  std::vector<std::uint8_t> held = {};  ///< 1 where the shape is a lasting rest shape; else 0.
  std::vector<float> stiffness_factors = {};         ///< On Young's modulus, applied.
  std::vector<float> needed_stiffness_factors = {};  ///< The least that holds; 0 without `hold`.
  /// Distances at rest from the fitted shape, after a small push to the worse side [m]: of the tip,
  /// and of the farthest end of an element.
  std::vector<float> tip_deviations = {};
  std::vector<float> largest_deviations = {};
};

}  // namespace mane::inline client
