// Beam styles between the API and the domain: there and back, defaults, and the name of what is
// wrong.

#include "rpc/convert_beam_style.h"

#include <gtest/gtest.h>

#include <google/protobuf/util/message_differencer.h>

#include <cmath>
#include <functional>
#include <limits>

namespace mane::rpc {
namespace {

using google::protobuf::util::MessageDifferencer;

// A document in which every field has a value that is not its default.
v1::BeamStyle Whole() {
  const auto set_vector = [](v1::Vector3* v, double x, double y, double z) {
    v->set_x(x);
    v->set_y(y);
    v->set_z(z);
  };
  const auto set_pores = [](v1::PoreRegion* pores, double shift) {
    pores->mutable_zenith()->set_low(0.1 + shift);
    pores->mutable_zenith()->set_high(1.5 + shift);
    pores->mutable_azimuth()->set_low(2 + shift);
    pores->mutable_azimuth()->set_high(-2 + shift);
  };
  const auto set_half_space = [&](v1::BeamHalfSpace* half_space, double offset) {
    set_vector(half_space->mutable_normal(), 0, -1, 2);
    half_space->set_offset_m(offset);
  };
  const auto add_forces_and_cuts = [&](auto* message) {
    v1::BeamForce* uniform = message->add_forces();
    uniform->set_kind(v1::BeamForce::KIND_UNIFORM);
    set_vector(uniform->mutable_acceleration(), 1, 2, 3);
    v1::BeamForce* around = message->add_forces();
    around->set_kind(v1::BeamForce::KIND_AROUND);
    set_vector(around->mutable_point(), 0.1, 0.2, 0.3);
    around->set_strength_m_s2(12);
    around->set_softening_m(0.03);
    set_half_space(around->add_where(), 0.05);
    set_pores(around->mutable_pores(), 0.01);
    message->add_forces()->set_kind(v1::BeamForce::KIND_TOWARD);
    v1::BeamCut* cut = message->add_cuts();
    set_pores(cut->mutable_pores(), 0.02);
    cut->set_height_m(0);
    set_half_space(cut->add_keep(), -0.04);
    cut->mutable_by_pore()->set_low_y_m(0.01);
    cut->mutable_by_pore()->set_low_length_m(0.02);
    cut->mutable_by_pore()->set_high_y_m(0.03);
    cut->mutable_by_pore()->set_high_length_m(0.04);
  };
  v1::BeamStyle style;
  style.set_seed(7);
  style.set_gravity_m_s2(0);
  style.set_ambient_deviation(0.3);
  style.set_guide_count(40);
  add_forces_and_cuts(&style);
  v1::BeamPart* part = style.add_parts();
  part->set_name("tail");
  set_pores(part->mutable_pores(), 0);
  set_vector(part->mutable_tied_at(), 0, 0.1, -0.2);
  part->set_tied_radius_m(0.02);
  set_vector(part->mutable_tied_along(), 0, 1, -1);
  part->set_spread(v1::BeamPart::SPREAD_UNIFORM);
  part->set_hair_count(123);
  part->set_segment_count(12);
  part->set_length_m(0.4);
  part->set_length_fluctuation(0.1);
  part->set_rigidity_n_m2(1e-8);
  part->set_rigidity_fluctuation(0.2);
  part->set_line_density_kg_m(7e-6);
  add_forces_and_cuts(part);
  return style;
}

TEST(ConvertBeamStyle, ThereAndBackIsTheSame) {
  const v1::BeamStyle whole = Whole();
  const auto document = ToBeamStyle(whole, "style");
  ASSERT_TRUE(document) << document.error().message;
  std::string difference;
  MessageDifferencer differencer;
  differencer.ReportDifferencesToString(&difference);
  EXPECT_TRUE(differencer.Compare(whole, FromBeamStyle(*document))) << difference;
}

TEST(ConvertBeamStyle, MeansWhatItSays) {
  const auto document = ToBeamStyle(Whole(), "style");
  ASSERT_TRUE(document);
  EXPECT_EQ(document->guide_count, 40);
  const beam::BeamStyle& style = document->style;
  EXPECT_EQ(style.seed, 7U);
  EXPECT_EQ(style.gravity, 0);
  const beam::Part& part = style.parts.at(0);
  EXPECT_EQ(part.count, 123);
  EXPECT_EQ(part.segments, 12);
  EXPECT_EQ(part.spread, beam::Part::Spread::kUniform);
  EXPECT_EQ(part.pores.from_azimuth, 2);
  EXPECT_EQ(part.pores.to_azimuth, -2);
  EXPECT_EQ(*part.tied_at, Eigen::Vector3d(0, 0.1, -0.2));
  EXPECT_EQ(style.forces.at(0).kind, beam::Force::Kind::kUniform);
  EXPECT_EQ(style.forces.at(1).kind, beam::Force::Kind::kAround);
  EXPECT_EQ(style.forces.at(1).where.at(0).offset, 0.05);
  EXPECT_EQ(style.forces.at(2).kind, beam::Force::Kind::kToward);
  EXPECT_EQ(style.cuts.at(0).height, 0);
  EXPECT_EQ(part.cuts.at(0).by_pore->high_length, 0.04);
}

TEST(ConvertBeamStyle, WhatIsUnsetHasItsDefault) {
  v1::BeamStyle message;
  message.add_parts();
  message.mutable_parts(0)->add_forces();
  const auto document = ToBeamStyle(message, "style");
  ASSERT_TRUE(document) << document.error().message;
  EXPECT_EQ(document->guide_count, 300);
  const beam::Part& part = document->style.parts.at(0);
  EXPECT_EQ(part.count, 10'000);
  EXPECT_EQ(part.spread, beam::Part::Spread::kRandom);
  EXPECT_EQ(part.tied_along, Eigen::Vector3d(0, 0, -1));
  EXPECT_FALSE(part.tied_at);
  EXPECT_EQ(part.forces.at(0).kind, beam::Force::Kind::kUniform);
  EXPECT_EQ(part.forces.at(0).softening, 0.01);
  message.mutable_parts(0)->clear_forces();
  EXPECT_TRUE(MessageDifferencer::Equals(message, FromBeamStyle(*ToBeamStyle(message, "style"))));
}

TEST(ConvertBeamStyle, WhatIsWrongIsNamed) {
  using Style = v1::BeamStyle*;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  const struct {
    const char* field;
    std::function<void(Style)> change;
  } cases[] = {
      {"gravity_m_s2", [](Style s) { s->set_gravity_m_s2(-1); }},
      {"ambient_deviation", [](Style s) { s->set_ambient_deviation(1.1); }},
      {"guide_count", [](Style s) { s->set_guide_count(0); }},
      {"guide_count", [](Style s) { s->set_guide_count(20'001); }},
      {"parts", [](Style s) { s->clear_parts(); }},
      {"parts",
       [](Style s) {
         while (s->parts_size() < 17) s->add_parts();
       }},
      {"parts",
       [](Style s) {
         s->mutable_parts(0)->set_hair_count(100'000);
         s->add_parts()->set_hair_count(100'001);
       }},
      {"parts",
       [](Style s) {
         s->mutable_parts(0)->set_hair_count(100'000);
         s->mutable_parts(0)->set_segment_count(100);
       }},
      {"forces",
       [](Style s) {
         while (s->forces_size() < 17) s->add_forces();
       }},
      {"parts[0].forces",
       [](Style s) {
         while (s->parts(0).forces_size() < 17) s->mutable_parts(0)->add_forces();
       }},
      {"cuts",
       [](Style s) {
         while (s->cuts_size() < 17) *s->add_cuts() = s->cuts(0);
       }},
      {"parts[0].name", [](Style s) { s->mutable_parts(0)->set_name(std::string(65, 'a')); }},
      {"parts[0].pores.zenith.low",
       [](Style s) { s->mutable_parts(0)->mutable_pores()->mutable_zenith()->set_low(-0.1); }},
      {"parts[0].pores.zenith.low",
       [](Style s) { s->mutable_parts(0)->mutable_pores()->mutable_zenith()->set_low(1.5); }},
      {"parts[0].pores.zenith.high",
       [](Style s) { s->mutable_parts(0)->mutable_pores()->mutable_zenith()->set_high(3.2); }},
      {"parts[0].pores.azimuth.low",
       [](Style s) { s->mutable_parts(0)->mutable_pores()->mutable_azimuth()->set_low(-3.2); }},
      {"parts[0].pores.azimuth.high",
       [](Style s) { s->mutable_parts(0)->mutable_pores()->mutable_azimuth()->set_high(3.2); }},
      {"parts[0].tied_at", [](Style s) { s->mutable_parts(0)->mutable_tied_at()->set_x(kNan); }},
      {"parts[0].tied_radius_m", [](Style s) { s->mutable_parts(0)->set_tied_radius_m(-1); }},
      {"parts[0].tied_along", [](Style s) { s->mutable_parts(0)->mutable_tied_along()->Clear(); }},
      {"parts[0].spread",
       [](Style s) { s->mutable_parts(0)->set_spread(static_cast<v1::BeamPart::Spread>(3)); }},
      {"parts[0].hair_count", [](Style s) { s->mutable_parts(0)->set_hair_count(0); }},
      {"parts[0].hair_count", [](Style s) { s->mutable_parts(0)->set_hair_count(~0U); }},
      {"parts[0].segment_count", [](Style s) { s->mutable_parts(0)->set_segment_count(1); }},
      {"parts[0].segment_count", [](Style s) { s->mutable_parts(0)->set_segment_count(~0U); }},
      {"parts[0].length_m", [](Style s) { s->mutable_parts(0)->set_length_m(0); }},
      {"parts[0].length_m", [](Style s) { s->mutable_parts(0)->set_length_m(kNan); }},
      {"parts[0].length_fluctuation",
       [](Style s) { s->mutable_parts(0)->set_length_fluctuation(1); }},
      {"parts[0].rigidity_n_m2", [](Style s) { s->mutable_parts(0)->set_rigidity_n_m2(0); }},
      {"parts[0].rigidity_fluctuation",
       [](Style s) { s->mutable_parts(0)->set_rigidity_fluctuation(-0.1); }},
      {"parts[0].line_density_kg_m",
       [](Style s) { s->mutable_parts(0)->set_line_density_kg_m(2); }},
      {"forces[0].kind",
       [](Style s) { s->mutable_forces(0)->set_kind(static_cast<v1::BeamForce::Kind>(4)); }},
      {"forces[0].acceleration",
       [](Style s) { s->mutable_forces(0)->mutable_acceleration()->set_y(1e5); }},
      {"forces[1].point", [](Style s) { s->mutable_forces(1)->mutable_point()->set_z(101); }},
      {"forces[1].strength_m_s2", [](Style s) { s->mutable_forces(1)->set_strength_m_s2(-1); }},
      {"forces[1].softening_m", [](Style s) { s->mutable_forces(1)->set_softening_m(0); }},
      {"forces[1].pores.zenith.low",
       [](Style s) { s->mutable_forces(1)->mutable_pores()->mutable_zenith()->set_low(4); }},
      {"forces[1].where",
       [](Style s) {
         auto* force = s->mutable_forces(1);
         while (force->where_size() < 9) *force->add_where() = force->where(0);
       }},
      {"forces[1].where[1].normal", [](Style s) { s->mutable_forces(1)->add_where(); }},
      {"forces[1].where[0].offset_m",
       [](Style s) { s->mutable_forces(1)->mutable_where(0)->set_offset_m(kNan); }},
      {"parts[0].cuts[0].height_m",
       [](Style s) { s->mutable_parts(0)->mutable_cuts(0)->set_height_m(101); }},
      {"parts[0].cuts[1].height_m", [](Style s) { s->mutable_parts(0)->add_cuts(); }},
      {"cuts[0].keep[0].normal",
       [](Style s) { s->mutable_cuts(0)->mutable_keep(0)->clear_normal(); }},
      {"cuts[0].keep",
       [](Style s) {
         auto* cut = s->mutable_cuts(0);
         while (cut->keep_size() < 9) *cut->add_keep() = cut->keep(0);
       }},
      {"cuts[0].by_pore.low_y_m",
       [](Style s) { s->mutable_cuts(0)->mutable_by_pore()->set_low_y_m(0.05); }},
      {"cuts[0].by_pore.low_length_m",
       [](Style s) { s->mutable_cuts(0)->mutable_by_pore()->set_low_length_m(-1); }},
      {"cuts[0].by_pore.high_length_m",
       [](Style s) { s->mutable_cuts(0)->mutable_by_pore()->set_high_length_m(6); }},
      {"cuts[0].by_pore.high_y_m",
       [](Style s) { s->mutable_cuts(0)->mutable_by_pore()->set_high_y_m(kNan); }},
  };
  for (const auto& wrong : cases) {
    SCOPED_TRACE(wrong.field);
    v1::BeamStyle message = Whole();
    wrong.change(&message);
    const auto document = ToBeamStyle(message, "style");
    ASSERT_FALSE(document);
    EXPECT_EQ(document.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(document.error().field, std::string("style.") + wrong.field);
    EXPECT_NE(document.error().message.find(document.error().field), std::string::npos);
  }
}

}  // namespace
}  // namespace mane::rpc
