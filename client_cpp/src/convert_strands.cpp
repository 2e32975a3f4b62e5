#include "convert.h"

namespace mane::inline client {
namespace {

v1::HairProperties ToProto(const HairProperties& properties) {
  v1::HairProperties out;
  if (properties.radius_1_m) out.set_radius_1_m(*properties.radius_1_m);
  if (properties.radius_2_m) out.set_radius_2_m(*properties.radius_2_m);
  if (properties.young_modulus_pa) out.set_young_modulus_pa(*properties.young_modulus_pa);
  if (properties.poisson_ratio) out.set_poisson_ratio(*properties.poisson_ratio);
  if (properties.density_kg_m3) out.set_density_kg_m3(*properties.density_kg_m3);
  if (properties.internal_friction) out.set_internal_friction(*properties.internal_friction);
  if (properties.air_drag) out.set_air_drag(*properties.air_drag);
  return out;
}

}  // namespace

v1::ImportedStrand ToProto(const ImportedStrand& strand) {
  v1::ImportedStrand out;
  out.mutable_points()->assign(reinterpret_cast<const char*>(strand.points.data()),
                               strand.points.size() * sizeof(float));
  if (strand.root_frame) *out.mutable_root_frame() = ToProto(*strand.root_frame);
  *out.mutable_properties() = ToProto(strand.properties);
  return out;
}

v1::ImportOptions ToProto(const ImportOptions& options) {
  v1::ImportOptions out;
  out.set_hair_type(static_cast<v1::HairType>(options.hair_type));
  *out.mutable_properties() = ToProto(options.properties);
  out.set_element_count(options.element_count);
  out.set_error_bound_m(options.error_bound_m);
  if (options.noise_m) out.set_noise_m(*options.noise_m);
  out.set_hold(options.hold);
  out.set_max_stiffness_factor(options.max_stiffness_factor);
  out.set_stability_margin(options.stability_margin);
  out.set_wisp_radius_m(options.wisp_radius_m);
  return out;
}

ImportSummary FromProto(const v1::ImportSummary& summary) {
  return {.strand_count = summary.strand_count(),
          .point_count = summary.point_count(),
          .largest_fit_distance_m = summary.largest_fit_distance_m(),
          .rms_fit_distance_m = summary.rms_fit_distance_m(),
          .bound_missed_count = summary.bound_missed_count(),
          .not_held_count = summary.not_held_count(),
          .largest_tip_deviation_m = summary.largest_tip_deviation_m(),
          .largest_stiffness_factor = summary.largest_stiffness_factor()};
}

ImportReport FromProto(const v1::ImportReport& report) {
  return {.summary = FromProto(report.summary()),
          .element_counts = Numbers<std::uint32_t>(report.element_counts()),
          .largest_fit_distances = Numbers<float>(report.largest_fit_distances()),
          .rms_fit_distances = Numbers<float>(report.rms_fit_distances()),
          .bounds_met = Numbers<std::uint8_t>(report.bounds_met()),
          .held = Numbers<std::uint8_t>(report.held()),
          .stiffness_factors = Numbers<float>(report.stiffness_factors()),
          .needed_stiffness_factors = Numbers<float>(report.needed_stiffness_factors()),
          .tip_deviations = Numbers<float>(report.tip_deviations()),
          .largest_deviations = Numbers<float>(report.largest_deviations())};
}

}  // namespace mane::inline client
