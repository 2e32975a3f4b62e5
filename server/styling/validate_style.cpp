#include "styling/validate_style.h"

#include <fmt/format.h>

#include "groom/range.h"
#include "styling/constraint.h"
#include "styling/distribution.h"
#include "styling/force_field.h"
#include "styling/map.h"
#include "styling/prototype.h"
#include "styling/region.h"
#include "styling/synthesis.h"

namespace mane::styling {
namespace {

using groom::Range;

constexpr double kLongest = 5;  // Of a strand [m].
constexpr Range kSegmentRange{1e-3, 0.1, "m"};
constexpr Range kRadiusRange{0, 0.2, "m"};
constexpr Range kFuzzinessRange{0, 1};
constexpr Range kStiffnessRange{0, 1000};
constexpr Range kThresholdRange{0, 1, "", true};
constexpr Range kCrossSectionRange{0, 1e-4, "m^2"};
constexpr Range kCellRange{1e-3, 0.1, "m"};
constexpr Range kShareRange{0, 1};
constexpr Range kCutRange{0, kLongest, "m", true};
constexpr Range kNormalRange{1e-6, 1e6};
constexpr Range kOffsetRange{-100, 100, "m"};
constexpr Range kConstraintRadiusRange{0, 10, "m", true};
constexpr Range kBraidRadiusRange{1e-3, 1, "m"};
constexpr Range kBraidPeriodRange{5e-3, 10, "m"};

Result<void> Check(const std::string& field, double value, const Range& range) {
  if (range.Contains(value)) return {};
  return groom::OutOfRange(field, value, range);
}

Result<void> ValidateSynthesis(const Synthesis& synthesis, double segment_length,
                               const std::string& field) {
  const auto pattern = PrototypeDetails(synthesis.prototype, segment_length, field + ".prototype");
  if (!pattern) return pattern.error();
  const auto model = PrototypeModel::Make(*pattern, synthesis, field);
  return model ? Result<void>() : Result<void>(model.error());
}

Result<void> ValidateNumbers(const Style& style, const std::string& field) {
  const struct {
    const char* name;
    double value;
    const Range& range;
  } numbers[] = {{"segment_length_m", style.segment_length, kSegmentRange},
                 {"fuzziness", style.fuzziness, kFuzzinessRange},
                 {"bending_stiffness", style.bending_stiffness, kStiffnessRange},
                 {"density_threshold", style.density_threshold, kThresholdRange},
                 {"strand_cross_section_m2", style.strand_cross_section, kCrossSectionRange},
                 {"cell_m", style.cell, kCellRange}};
  for (const auto& number : numbers) {
    const auto ok = Check(fmt::format("{}.{}", field, number.name), number.value, number.range);
    if (!ok) return ok;
  }
  for (size_t i = 0; i < style.radii.size(); ++i) {
    const auto ok = Check(fmt::format("{}.radii_m[{}]", field, i), style.radii[i], kRadiusRange);
    if (!ok) return ok;
  }
  return {};
}

Result<void> ValidateColouring(const Colouring& colour, const std::string& field) {
  if (const auto ok = Validate(colour.hue, field + ".hue", -1, 2); !ok) return ok;
  if (const auto ok = Validate(colour.saturation, field + ".saturation", 0, 1); !ok) return ok;
  if (const auto ok = Validate(colour.value, field + ".value", 0, 1); !ok) return ok;
  return Check(field + ".wisp_share", colour.wisp_share, kShareRange);
}

struct WhatValidator {
  const std::string& field;
  double segment_length;

  Result<void> operator()(const Operation::Trim& trim) const {
    if (trim.length) return Check(field + ".cut.length_m", *trim.length, kCutRange);
    return {};  // Its plane is looked at with the regions.
  }
  Result<void> operator()(const Operation::Wave& wave) const {
    return ValidateSynthesis(wave.synthesis, segment_length, field + ".wave.synthesis");
  }
  Result<void> operator()(const Operation::Comb& comb) const {
    const Constraint lead{Constraint::Kind::kDirection, comb.path, comb.radius, comb.weight};
    return Validate(lead, Obstacles(), field + ".comb");
  }
  Result<void> operator()(const Operation::Tie& tie) const {
    const auto ok = groom::CheckVector(field + ".tie.point", tie.point, kOffsetRange);
    if (!ok) return ok;
    return Check(field + ".tie.radius_m", tie.radius, kConstraintRadiusRange);
  }
  Result<void> operator()(const Operation::Braid& braid) const {
    const Constraint axis{Constraint::Kind::kTrajectory, braid.path, braid.radius, 1};
    if (const auto ok = Validate(axis, Obstacles(), field + ".braid"); !ok) return ok;
    const auto ok = Check(field + ".braid.radius_m", braid.radius, kBraidRadiusRange);
    if (!ok) return ok;
    return Check(field + ".braid.period_m", braid.period, kBraidPeriodRange);
  }
};

}  // namespace

Result<void> ValidateStyle(const Style& style, const std::string& field) {
  if (const auto ok = ValidateNumbers(style, field); !ok) return ok;
  const auto density = Validate(style.density, field + ".density", 0, kLargestFactor);
  if (!density) return density;
  if (const auto ok = Validate(style.length, field + ".length", 0, kLongest); !ok) return ok;
  if (const auto ok = Validate(style.protrusion, field + ".protrusion", 0, 1); !ok) return ok;
  const auto synthesis =
      ValidateSynthesis(style.synthesis, style.segment_length, field + ".synthesis");
  if (!synthesis) return synthesis;
  for (size_t i = 0; i < style.regional.size(); ++i) {
    const std::string path = fmt::format("{}.regional[{}]", field, i);
    const auto& [region, own] = style.regional[i];
    if (const auto ok = Validate(region, path + ".region", style.wisp_count); !ok) return ok;
    if (const auto ok = ValidateSynthesis(own, style.segment_length, path + ".synthesis"); !ok) {
      return ok;
    }
  }
  const auto members = Validate(style.member_length, field + ".member_length", 0, 2);
  if (!members) return members;
  if (const auto ok = Validate(style.field, field + ".field"); !ok) return ok;
  for (size_t i = 0; i < style.queues.size(); ++i) {
    const auto ok = Validate(style.queues[i].selection,
                             fmt::format("{}.queues[{}].selection", field, i), style.wisp_count);
    if (!ok) return ok;
  }
  const auto queues = Validate(style.queues, Obstacles(), field + ".queues");
  if (!queues) return queues;
  return ValidateColouring(style.colour, field + ".colour");
}

Result<void> ValidateOperation(const Operation& operation, const Style& style,
                               const std::string& field) {
  const auto region = Validate(operation.region, field + ".region", style.wisp_count);
  if (!region) return region;
  if (const auto* trim = std::get_if<Operation::Trim>(&operation.what); trim && trim->plane) {
    const double length = trim->plane->normal.norm();
    if (const auto ok = Check(field + ".cut.plane.normal", length, kNormalRange); !ok) return ok;
    const auto ok = Check(field + ".cut.plane.offset_m", trim->plane->offset, kOffsetRange);
    if (!ok) return ok;
  }
  return std::visit(WhatValidator{field, style.segment_length}, operation.what);
}

}  // namespace mane::styling
