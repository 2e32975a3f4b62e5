// Styles that no head could wear are refused, by the name of what is wrong.

#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "beam/style.h"

namespace mane::beam {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Three parts, the last with a force and a cut, both with half-spaces.
BeamStyle Whole() {
  BeamStyle style;
  style.parts.resize(3);
  style.parts[1].tied_at = Eigen::Vector3d(0, 0, -0.2);
  Force force;
  force.where.resize(2);
  style.forces = {force};
  force.kind = Force::Kind::kToward;
  style.parts[2].forces = {force};
  Cut cut;
  cut.by_pore = Cut::ByPore{0, 0.1, 0.1, 0.2};
  cut.keep.resize(1);
  style.parts[2].cuts = {cut};
  style.cuts = {cut};
  return style;
}

TEST(ValidateBeamStyleTest, AcceptsWhatIsWhole) {
  EXPECT_TRUE(ValidateBeamStyle(Whole(), "style"));
  BeamStyle least;
  least.parts.resize(1);
  EXPECT_TRUE(ValidateBeamStyle(least, ""));
}

TEST(ValidateBeamStyleTest, NamesWhatIsWrong) {
  struct Case {
    std::string field;
    std::function<void(BeamStyle&)> change;
  };
  const Case cases[] = {
      {"gravity_m_s2", [](auto& s) { s.gravity = -1; }},
      {"gravity_m_s2", [](auto& s) { s.gravity = kNan; }},
      {"ambient_deviation", [](auto& s) { s.ambient_deviation = 1.5; }},
      {"parts", [](auto& s) { s.parts.clear(); }},
      {"parts", [](auto& s) { s.parts.resize(17); }},
      {"parts", [](auto& s) { s.parts[0].count = 190'000; }},
      {"parts", [](auto& s) { s.parts[0].count = 100'000, s.parts[0].segments = 150; }},
      {"parts[1].name", [](auto& s) { s.parts[1].name.assign(65, 'a'); }},
      {"parts[0].hair_count", [](auto& s) { s.parts[0].count = 0; }},
      {"parts[0].segment_count", [](auto& s) { s.parts[0].segments = 1; }},
      {"parts[0].segment_count", [](auto& s) { s.parts[0].segments = 201; }},
      {"parts[0].length_m", [](auto& s) { s.parts[0].length = kInfinity; }},
      {"parts[0].length_fluctuation", [](auto& s) { s.parts[0].length_fluctuation = 0.95; }},
      {"parts[0].rigidity_n_m2", [](auto& s) { s.parts[0].rigidity = 0; }},
      {"parts[0].rigidity_n_m2", [](auto& s) { s.parts[0].rigidity = -1e-9; }},
      {"parts[0].rigidity_fluctuation", [](auto& s) { s.parts[0].rigidity_fluctuation = -0.1; }},
      {"parts[0].line_density_kg_m", [](auto& s) { s.parts[0].line_density = 0; }},
      {"parts[1].tied_at", [](auto& s) { s.parts[1].tied_at->x() = kNan; }},
      {"parts[1].tied_radius_m", [](auto& s) { s.parts[1].tied_radius = -1; }},
      {"parts[0].tied_radius_m", [](auto& s) { s.parts[0].tied_radius = kNan; }},
      {"parts[1].tied_along", [](auto& s) { s.parts[1].tied_along.setZero(); }},
      {"parts[0].pores.zenith.low", [](auto& s) { s.parts[0].pores.least_zenith = 3.5; }},
      {"parts[0].pores.zenith.low",
       [](auto& s) {
         s.parts[0].pores = {1, 1, -1, 1};
       }},
      {"parts[0].pores.zenith.high", [](auto& s) { s.parts[0].pores.greatest_zenith = 4; }},
      {"parts[0].pores.azimuth.low", [](auto& s) { s.parts[0].pores.from_azimuth = -4; }},
      {"parts[0].pores.azimuth.low",
       [](auto& s) {
         s.parts[0].pores = {0, 1, 2, 2};
       }},
      {"parts[0].pores.azimuth.low",
       [](auto& s) {
         s.parts[0].pores = {0, 1, kPi, -kPi};
       }},
      {"parts[0].pores.azimuth.high", [](auto& s) { s.parts[0].pores.to_azimuth = kNan; }},
      {"forces", [](auto& s) { s.forces.resize(17); }},
      {"forces[0].acceleration", [](auto& s) { s.forces[0].vector.y() = 1e9; }},
      {"forces[0].where[1].normal", [](auto& s) { s.forces[0].where[1].normal.setZero(); }},
      {"forces[0].where[0].offset_m", [](auto& s) { s.forces[0].where[0].offset = kNan; }},
      {"forces[0].where", [](auto& s) { s.forces[0].where.resize(9); }},
      {"parts[2].forces[0].point", [](auto& s) { s.parts[2].forces[0].point.z() = kNan; }},
      {"parts[2].forces[0].strength_m_s2", [](auto& s) { s.parts[2].forces[0].strength = -1; }},
      {"parts[2].forces[0].softening_m", [](auto& s) { s.parts[2].forces[0].softening = 0; }},
      {"parts[2].forces[0].pores.zenith.low",
       [](auto& s) { s.parts[2].forces[0].pores.least_zenith = -1; }},
      {"cuts", [](auto& s) { s.cuts.resize(17); }},
      {"cuts[0].height_m", [](auto& s) { s.cuts[0] = {}; }},
      {"cuts[0].height_m", [](auto& s) { s.cuts[0].height = kNan; }},
      {"parts[2].cuts[0].pores.zenith.low",
       [](auto& s) { s.parts[2].cuts[0].pores.least_zenith = kNan; }},
      {"parts[2].cuts[0].keep[0].normal",
       [](auto& s) { s.parts[2].cuts[0].keep[0].normal.setZero(); }},
      {"parts[2].cuts[0].by_pore.low_y_m",
       [](auto& s) { s.parts[2].cuts[0].by_pore->low_y = 0.1; }},
      {"parts[2].cuts[0].by_pore.high_length_m",
       [](auto& s) { s.parts[2].cuts[0].by_pore->high_length = -1; }},
  };
  for (const auto& [field, change] : cases) {
    SCOPED_TRACE(field);
    BeamStyle style = Whole();
    change(style);
    const auto ok = ValidateBeamStyle(style, "style");
    ASSERT_FALSE(ok);
    EXPECT_EQ(ok.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(ok.error().field, "style." + field);
    EXPECT_FALSE(ok.error().message.empty());
  }
}

}  // namespace
}  // namespace mane::beam
