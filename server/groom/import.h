#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "base/cancelled.h"
#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "groom/limits.h"

namespace mane::groom {

/// Bounds of one imported strand.
inline constexpr int kMaxPointsPerStrand = 1000;
inline constexpr int kMaxElementsPerStrand = 64;

/// Section, material and damping, as far as they are known: mane.v1.HairProperties.
struct HairProperties {
  std::optional<double> radius_1_m = {};
  std::optional<double> radius_2_m = {};
  std::optional<double> young_modulus_pa = {};
  std::optional<double> poisson_ratio = {};
  std::optional<double> density_kg_m3 = {};
  std::optional<double> internal_friction = {};
  std::optional<double> air_drag = {};
};

/// A polyline that is to become a guide: mane.v1.ImportedStrand, whose comments give meanings and
/// ranges.
struct ImportedStrand {
  std::vector<Eigen::Vector3f> points;  ///< Head frame [m], root first.
  std::optional<Eigen::Quaterniond> root_frame;
  HairProperties properties;
};

/// mane.v1.ImportOptions, whose comments give meanings and ranges.
struct ImportOptions {
  HairType hair_type = HairType::kCustom;  ///< Must be set to a preset.
  HairProperties properties;
  uint32_t element_count = 20;
  double error_bound_m = 0;  ///< 0 for none.
  std::optional<double> noise_m;
  bool hold = true;
  double max_stiffness_factor = 4;
  double stability_margin = 0.1;
  double wisp_radius_m = 0;  ///< Of every guide.
};

/// What became of one strand; mane.v1.ImportReport.
struct StrandOutcome {
  uint32_t point_count = 0;
  uint32_t element_count = 0;
  float largest_fit_distance = 0;  ///< [m]
  float rms_fit_distance = 0;      ///< [m]
  bool bound_met = true;
  bool held = false;
  float stiffness_factor = 1;
  float needed_stiffness_factor = 0;  ///< 0 where `hold` is false.
  float tip_deviation = 0;            ///< [m]
  float largest_deviation = 0;        ///< [m]
};

/// Imported guides.
struct Import {
  std::vector<Guide> guides;            ///< One for each strand, as MakeGuide makes them.
  std::vector<double> rest;             ///< For Parts::rest: the imported shapes [rad].
  std::vector<StrandOutcome> outcomes;  ///< One for each strand.
};

/// INVALID_ARGUMENT for the first field of `header.import_options` that is out of its range.
[[nodiscard]] Result<void> ValidateImportOptions(const ImportOptions& options);

/// INVALID_ARGUMENT for the first field of `strands[<index>]` that is out of its range, such as
/// `strands[12].points[3].y`.
///
/// @param options  valid.
[[nodiscard]] Result<void> ValidateStrand(const ImportedStrand& strand,
                                          const ImportOptions& options, int index);

/// What importing a strand of `points` points costs, in seconds of one core: 1e-3 a point and 1e-6
/// a cubed element, four times that where a bound is sought; and to hold the shape, 2e-3 an
/// element. So measured on one core of a rented EPYC for tight coils, whose fits take hundreds of
/// iterations; smooth strands take a tenth. Stepping a shape that stays takes 4e-4 an element, one
/// that does not up to nine times that.
[[nodiscard]] double ImportCost(size_t points, const ImportOptions& options);

/// Fits every strand (rod::FitPolyline) and, if asked to, holds its shape under (0, -9.81, 0) m/s^2
/// in the longest step of heads (rod::HoldShape). With a bound, a strand still has 5 elements, and
/// one per 4 cm, where `element_count` allows: fewer fit a straight strand, but do not move as hair
/// does.
///
/// Every strand is a piece of work of its own on `pool`. Same arguments, same bits.
///
/// @param strands    valid for `options`.
/// @param cancelled  asked before every strand.
/// @return INVALID_ARGUMENT naming `strands[<index>]` for the first that becomes no valid guide, of
///         which none is known: what would be out of a guide's range stays within it, and is not
///         held; CANCELLED. Limits are the caller's to check.
[[nodiscard]] Result<Import> ImportStrands(std::span<const ImportedStrand> strands,
                                           const ImportOptions& options, exec::WorkerPool& pool,
                                           const base::Cancelled& cancelled = {});

}  // namespace mane::groom
