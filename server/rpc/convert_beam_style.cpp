#include "rpc/convert_beam_style.h"

#include <vector>

#include "rpc/convert_style_values.h"
#include "rpc/convert_values.h"
#include "rpc/limits.h"

namespace mane::rpc {
namespace {

constexpr int kMostParts = 16;
constexpr int kMostForces = 16;
constexpr int kMostCuts = 16;
constexpr int kMostHalfSpaces = 8;
constexpr int kMostHairs = 200'000;
constexpr int kMostSegments = 200;
constexpr int kMostGuides = 20'000;

// Enumerators of the domain are those of the API in the same order, without UNSPECIFIED.
template <typename Domain>
Result<Domain> ToEnum(int value, int last, Domain unset, const std::string& field) {
  if (value == 0) return unset;
  if (value >= 1 && value <= last) return static_cast<Domain>(value - 1);
  return InvalidArgument(field, fmt::format("{} is {}; it must be 0 to {}", field, value, last));
}

beam::PoreRegion ToRegion(const v1::PoreRegion& message) {
  beam::PoreRegion region;
  if (message.has_zenith()) {
    region.least_zenith = message.zenith().low();
    region.greatest_zenith = message.zenith().high();
  }
  if (message.has_azimuth()) {
    region.from_azimuth = message.azimuth().low();
    region.to_azimuth = message.azimuth().high();
  }
  return region;
}

Result<beam::HalfSpace> ToHalfSpace(const v1::BeamHalfSpace& message,
                                    const std::string& /*field*/) {
  return beam::HalfSpace{ToVector(message.normal()), message.offset_m()};
}

Result<beam::Force> ToForce(const v1::BeamForce& message, const std::string& field) {
  using Kind = beam::Force::Kind;
  beam::Force force;
  const auto kind =
      ToEnum(message.kind(), v1::BeamForce::Kind_MAX, Kind::kUniform, field + ".kind");
  if (!kind) return kind.error();
  force.kind = *kind;
  force.vector = ToVector(message.acceleration());
  force.point = ToVector(message.point());
  force.strength = message.strength_m_s2();
  if (message.has_softening_m()) force.softening = message.softening_m();
  auto where = ToList(message.where(), field + ".where", kMostHalfSpaces, ToHalfSpace);
  if (!where) return where.error();
  force.where = *std::move(where);
  force.pores = ToRegion(message.pores());
  return force;
}

Result<beam::Cut> ToCut(const v1::BeamCut& message, const std::string& field) {
  beam::Cut cut;
  cut.pores = ToRegion(message.pores());
  if (message.has_height_m()) cut.height = message.height_m();
  auto keep = ToList(message.keep(), field + ".keep", kMostHalfSpaces, ToHalfSpace);
  if (!keep) return keep.error();
  cut.keep = *std::move(keep);
  if (message.has_by_pore()) {
    const v1::BeamCut::ByPore& by_pore = message.by_pore();
    cut.by_pore = beam::Cut::ByPore{by_pore.low_y_m(), by_pore.low_length_m(), by_pore.high_y_m(),
                                    by_pore.high_length_m()};
  }
  return cut;
}

// Of a style or a part: what both have.
template <typename Message, typename Domain>
Result<void> ToForcesAndCuts(const Message& message, const std::string& field, Domain* domain) {
  auto forces = ToList(message.forces(), field + ".forces", kMostForces, ToForce);
  if (!forces) return forces.error();
  domain->forces = *std::move(forces);
  auto cuts = ToList(message.cuts(), field + ".cuts", kMostCuts, ToCut);
  if (!cuts) return cuts.error();
  domain->cuts = *std::move(cuts);
  return {};
}

// Counts, which the domain has as int.
Result<void> ToCounts(const v1::BeamPart& message, const std::string& field, beam::Part* part) {
  if (message.has_hair_count()) {
    const auto ok = CheckRange(field + ".hair_count", message.hair_count(), 1, kMostHairs);
    if (!ok) return ok;
    part->count = static_cast<int>(message.hair_count());
  }
  if (message.has_segment_count()) {
    const auto ok = CheckRange(field + ".segment_count", message.segment_count(), 2, kMostSegments);
    if (!ok) return ok;
    part->segments = static_cast<int>(message.segment_count());
  }
  return {};
}

Result<beam::Part> ToPart(const v1::BeamPart& message, const std::string& field) {
  using Spread = beam::Part::Spread;
  beam::Part part;
  part.name = message.name();
  part.pores = ToRegion(message.pores());
  if (message.has_tied_at()) part.tied_at = ToVector(message.tied_at());
  if (message.has_tied_radius_m()) part.tied_radius = message.tied_radius_m();
  if (message.has_tied_along()) part.tied_along = ToVector(message.tied_along());
  const auto spread =
      ToEnum(message.spread(), v1::BeamPart::Spread_MAX, Spread::kRandom, field + ".spread");
  if (!spread) return spread.error();
  part.spread = *spread;
  if (const auto ok = ToCounts(message, field, &part); !ok) return ok.error();
  if (message.has_length_m()) part.length = message.length_m();
  part.length_fluctuation = message.length_fluctuation();
  if (message.has_rigidity_n_m2()) part.rigidity = message.rigidity_n_m2();
  part.rigidity_fluctuation = message.rigidity_fluctuation();
  if (message.has_line_density_kg_m()) part.line_density = message.line_density_kg_m();
  if (const auto ok = ToForcesAndCuts(message, field, &part); !ok) return ok.error();
  return part;
}

// To the message; what has its default is left unset.

template <typename Message>
void FromRegion(const beam::PoreRegion& region, Message* message) {
  const beam::PoreRegion all;
  if (region.least_zenith != all.least_zenith || region.greatest_zenith != all.greatest_zenith) {
    v1::PoreRegion::Interval* zenith = message->mutable_pores()->mutable_zenith();
    zenith->set_low(region.least_zenith);
    zenith->set_high(region.greatest_zenith);
  }
  if (region.from_azimuth != all.from_azimuth || region.to_azimuth != all.to_azimuth) {
    v1::PoreRegion::Interval* azimuth = message->mutable_pores()->mutable_azimuth();
    azimuth->set_low(region.from_azimuth);
    azimuth->set_high(region.to_azimuth);
  }
}

void FromHalfSpaces(const std::vector<beam::HalfSpace>& half_spaces,
                    google::protobuf::RepeatedPtrField<v1::BeamHalfSpace>* messages) {
  for (const beam::HalfSpace& half_space : half_spaces) {
    v1::BeamHalfSpace* message = messages->Add();
    FromVector(half_space.normal, message->mutable_normal());
    message->set_offset_m(half_space.offset);
  }
}

void FromForce(const beam::Force& force, v1::BeamForce* message) {
  message->set_kind(static_cast<v1::BeamForce::Kind>(static_cast<int>(force.kind) + 1));
  if (!force.vector.isZero(0)) FromVector(force.vector, message->mutable_acceleration());
  if (!force.point.isZero(0)) FromVector(force.point, message->mutable_point());
  message->set_strength_m_s2(force.strength);
  if (force.softening != beam::Force().softening) message->set_softening_m(force.softening);
  FromHalfSpaces(force.where, message->mutable_where());
  FromRegion(force.pores, message);
}

void FromCut(const beam::Cut& cut, v1::BeamCut* message) {
  FromRegion(cut.pores, message);
  if (cut.height) message->set_height_m(*cut.height);
  FromHalfSpaces(cut.keep, message->mutable_keep());
  if (!cut.by_pore) return;
  message->mutable_by_pore()->set_low_y_m(cut.by_pore->low_y);
  message->mutable_by_pore()->set_low_length_m(cut.by_pore->low_length);
  message->mutable_by_pore()->set_high_y_m(cut.by_pore->high_y);
  message->mutable_by_pore()->set_high_length_m(cut.by_pore->high_length);
}

template <typename Domain, typename Message>
void FromForcesAndCuts(const Domain& domain, Message* message) {
  for (const beam::Force& force : domain.forces) FromForce(force, message->add_forces());
  for (const beam::Cut& cut : domain.cuts) FromCut(cut, message->add_cuts());
}

void FromPart(const beam::Part& part, v1::BeamPart* message) {
  const beam::Part unset;
  message->set_name(part.name);
  FromRegion(part.pores, message);
  if (part.tied_at) FromVector(*part.tied_at, message->mutable_tied_at());
  if (part.tied_radius != unset.tied_radius) message->set_tied_radius_m(part.tied_radius);
  if (part.tied_along != unset.tied_along) {
    FromVector(part.tied_along, message->mutable_tied_along());
  }
  if (part.spread != unset.spread) {
    message->set_spread(static_cast<v1::BeamPart::Spread>(static_cast<int>(part.spread) + 1));
  }
  if (part.count != unset.count) message->set_hair_count(static_cast<uint32_t>(part.count));
  if (part.segments != unset.segments) {
    message->set_segment_count(static_cast<uint32_t>(part.segments));
  }
  if (part.length != unset.length) message->set_length_m(part.length);
  message->set_length_fluctuation(part.length_fluctuation);
  if (part.rigidity != unset.rigidity) message->set_rigidity_n_m2(part.rigidity);
  message->set_rigidity_fluctuation(part.rigidity_fluctuation);
  if (part.line_density != unset.line_density) message->set_line_density_kg_m(part.line_density);
  FromForcesAndCuts(part, message);
}

}  // namespace

Result<BeamDocument> ToBeamStyle(const v1::BeamStyle& message, const std::string& field) {
  BeamDocument document;
  beam::BeamStyle& style = document.style;
  style.seed = message.seed();
  if (message.has_gravity_m_s2()) style.gravity = message.gravity_m_s2();
  if (message.has_ambient_deviation()) style.ambient_deviation = message.ambient_deviation();
  auto parts = ToList(message.parts(), field + ".parts", kMostParts, ToPart);
  if (!parts) return parts.error();
  style.parts = *std::move(parts);
  if (const auto ok = ToForcesAndCuts(message, field, &style); !ok) return ok.error();
  if (message.has_guide_count()) {
    const auto ok = CheckRange(field + ".guide_count", message.guide_count(), 1, kMostGuides);
    if (!ok) return ok.error();
    document.guide_count = static_cast<int>(message.guide_count());
  }
  if (const auto ok = beam::ValidateBeamStyle(style, field); !ok) return ok.error();
  return document;
}

v1::BeamStyle FromBeamStyle(const BeamDocument& document) {
  const beam::BeamStyle& style = document.style;
  const BeamDocument unset;
  v1::BeamStyle message;
  message.set_seed(style.seed);
  if (style.gravity != unset.style.gravity) message.set_gravity_m_s2(style.gravity);
  if (style.ambient_deviation != unset.style.ambient_deviation) {
    message.set_ambient_deviation(style.ambient_deviation);
  }
  for (const beam::Part& part : style.parts) FromPart(part, message.add_parts());
  FromForcesAndCuts(style, &message);
  if (document.guide_count != unset.guide_count) {
    message.set_guide_count(static_cast<uint32_t>(document.guide_count));
  }
  return message;
}

}  // namespace mane::rpc
