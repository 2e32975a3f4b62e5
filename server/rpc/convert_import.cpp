#include "rpc/convert_import.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "rpc/convert_groom.h"
#include "rpc/convert_values.h"

namespace mane::rpc {
namespace {

groom::HairProperties ToProperties(const v1::HairProperties& message) {
  groom::HairProperties properties;
  if (message.has_radius_1_m()) properties.radius_1_m = message.radius_1_m();
  if (message.has_radius_2_m()) properties.radius_2_m = message.radius_2_m();
  if (message.has_young_modulus_pa()) properties.young_modulus_pa = message.young_modulus_pa();
  if (message.has_poisson_ratio()) properties.poisson_ratio = message.poisson_ratio();
  if (message.has_density_kg_m3()) properties.density_kg_m3 = message.density_kg_m3();
  if (message.has_internal_friction()) properties.internal_friction = message.internal_friction();
  if (message.has_air_drag()) properties.air_drag = message.air_drag();
  return properties;
}

void FromProperties(const groom::HairProperties& properties, v1::HairProperties* message) {
  if (properties.radius_1_m) message->set_radius_1_m(*properties.radius_1_m);
  if (properties.radius_2_m) message->set_radius_2_m(*properties.radius_2_m);
  if (properties.young_modulus_pa) message->set_young_modulus_pa(*properties.young_modulus_pa);
  if (properties.poisson_ratio) message->set_poisson_ratio(*properties.poisson_ratio);
  if (properties.density_kg_m3) message->set_density_kg_m3(*properties.density_kg_m3);
  if (properties.internal_friction) message->set_internal_friction(*properties.internal_friction);
  if (properties.air_drag) message->set_air_drag(*properties.air_drag);
}

void FromOptions(const groom::ImportOptions& options, v1::ImportOptions* message) {
  message->set_hair_type(static_cast<v1::HairType>(options.hair_type));
  FromProperties(options.properties, message->mutable_properties());
  message->set_element_count(options.element_count);
  message->set_error_bound_m(options.error_bound_m);
  if (options.noise_m) message->set_noise_m(*options.noise_m);
  message->set_hold(options.hold);
  message->set_max_stiffness_factor(options.max_stiffness_factor);
  message->set_stability_margin(options.stability_margin);
  message->set_wisp_radius_m(options.wisp_radius_m);
}

void Summarize(std::span<const groom::StrandOutcome> outcomes, v1::ImportSummary* summary) {
  uint64_t points = 0;
  uint32_t missed = 0, not_held = 0;
  double largest = 0, squares = 0, tip = 0, factor = 1;
  for (const groom::StrandOutcome& strand : outcomes) {
    points += strand.point_count;
    missed += strand.bound_met ? 0 : 1;
    not_held += strand.held ? 0 : 1;
    largest = std::max<double>(largest, strand.largest_fit_distance);
    squares += strand.point_count * std::pow(strand.rms_fit_distance, 2);
    tip = std::max<double>(tip, strand.tip_deviation);
    factor = std::max<double>(factor, strand.stiffness_factor);
  }
  summary->set_strand_count(static_cast<uint32_t>(outcomes.size()));
  summary->set_point_count(points);
  summary->set_largest_fit_distance_m(largest);
  summary->set_rms_fit_distance_m(points == 0 ? 0 : std::sqrt(squares / double(points)));
  summary->set_bound_missed_count(missed);
  summary->set_not_held_count(not_held);
  summary->set_largest_tip_deviation_m(tip);
  summary->set_largest_stiffness_factor(factor);
}

// One member of every outcome, as little-endian numbers.
template <typename Number, typename Member>
std::string Column(std::span<const groom::StrandOutcome> outcomes, Member member) {
  std::string bytes;
  bytes.reserve(outcomes.size() * sizeof(Number));
  for (const groom::StrandOutcome& strand : outcomes) {
    const Number value = strand.*member;
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(Number));
  }
  return bytes;
}

}  // namespace

Result<groom::ImportOptions> ToImportOptions(const v1::ImportOptions& message) {
  const auto hair_type = ToHairType(message.hair_type(), "header.import_options.hair_type");
  if (!hair_type) return hair_type.error();
  groom::ImportOptions options;
  options.hair_type = *hair_type;
  options.properties = ToProperties(message.properties());
  if (message.element_count() != 0) options.element_count = message.element_count();
  options.error_bound_m = message.error_bound_m();
  if (message.has_noise_m()) options.noise_m = message.noise_m();
  if (message.has_hold()) options.hold = message.hold();
  if (message.has_max_stiffness_factor()) {
    options.max_stiffness_factor = message.max_stiffness_factor();
  }
  if (message.has_stability_margin()) options.stability_margin = message.stability_margin();
  options.wisp_radius_m = message.wisp_radius_m();
  return options;
}

Result<groom::ImportedStrand> ToImportedStrand(const v1::ImportedStrand& message, int index) {
  groom::ImportedStrand strand;
  const auto points =
      AppendBytes(message.points(), fmt::format("strands[{}].points", index), &strand.points);
  if (!points) return points.error();
  if (message.has_root_frame()) strand.root_frame = ToQuaternion(message.root_frame());
  strand.properties = ToProperties(message.properties());
  return strand;
}

void FromImport(const groom::ImportOptions& options, std::span<const groom::StrandOutcome> outcomes,
                v1::ImportReport* message) {
  using groom::StrandOutcome;
  Summarize(outcomes, message->mutable_summary());
  FromOptions(options, message->mutable_options());
  message->set_element_counts(Column<uint32_t>(outcomes, &StrandOutcome::element_count));
  message->set_largest_fit_distances(Column<float>(outcomes, &StrandOutcome::largest_fit_distance));
  message->set_rms_fit_distances(Column<float>(outcomes, &StrandOutcome::rms_fit_distance));
  message->set_bounds_met(Column<uint8_t>(outcomes, &StrandOutcome::bound_met));
  message->set_held(Column<uint8_t>(outcomes, &StrandOutcome::held));
  message->set_stiffness_factors(Column<float>(outcomes, &StrandOutcome::stiffness_factor));
  message->set_needed_stiffness_factors(
      Column<float>(outcomes, &StrandOutcome::needed_stiffness_factor));
  message->set_tip_deviations(Column<float>(outcomes, &StrandOutcome::tip_deviation));
  message->set_largest_deviations(Column<float>(outcomes, &StrandOutcome::largest_deviation));
}

}  // namespace mane::rpc
