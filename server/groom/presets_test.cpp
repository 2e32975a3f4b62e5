// Properties of the presets:
//   table      every number of [SH06] Appendix B comes back out of the preset
//   helix      natural curvatures are those of 4.2; straight hair has none
//   stiffness  a guide's stiffness and mass are the closed forms of its section, softest about n1
//   friction   gamma and nu lie in the ranges of 4.2

#include "groom/presets.h"

#include <gtest/gtest.h>

#include <numbers>
#include <ostream>

namespace mane::groom {
namespace {

using std::numbers::pi;

// A column of Appendix B, in its own units.
struct Column {
  HairType type;
  double radius_um, ellipticity, helix_radius_cm, helix_step_cm, young_gpa, poisson;
  friend void PrintTo(const Column& column, std::ostream* out) { *out << int(column.type); }
};

class PresetsTest : public ::testing::TestWithParam<Column> {};

INSTANTIATE_TEST_SUITE_P(
    AppendixB, PresetsTest,
    ::testing::Values(Column{HairType::kAsianSmooth, 50, 1, 0, 0, 1, 0.48},
                      Column{HairType::kCaucasianWavy, 35, 1.1, 1, 0.5, 2, 0.48},
                      Column{HairType::kCaucasianCurly, 50, 1.1, 0.6, 0.5, 1.5, 0.48},
                      Column{HairType::kAfricanFuzzy, 50, 1.2, 0.1, 1, 0.5, 0.48}));

TEST_P(PresetsTest, HasTheNumbersOfAppendixB) {
  const Column& column = GetParam();
  const Preset preset = PresetOf(column.type);
  const double a = preset.section.radius_1, b = preset.section.radius_2;
  EXPECT_NEAR((a + b) / 2, column.radius_um * 1e-6, 1e-12);
  EXPECT_NEAR(a / b, column.ellipticity, 1e-12);
  EXPECT_DOUBLE_EQ(preset.helix_radius, column.helix_radius_cm * 1e-2);
  EXPECT_DOUBLE_EQ(preset.helix_step, column.helix_step_cm * 1e-2);
  EXPECT_DOUBLE_EQ(preset.material.young_modulus, column.young_gpa * 1e9);
  EXPECT_DOUBLE_EQ(preset.material.poisson_ratio, column.poisson);
  EXPECT_DOUBLE_EQ(preset.material.density, 1300);
}

TEST_P(PresetsTest, CurvesAsTheHelixOfAppendixB) {
  const Column& column = GetParam();
  const Eigen::Vector3d natural = NaturalCurvature(PresetOf(column.type));
  if (column.helix_radius_cm == 0) {
    EXPECT_EQ(natural, Eigen::Vector3d::Zero());
    return;
  }
  const double r = column.helix_radius_cm * 1e-2, step = column.helix_step_cm * 1e-2;
  EXPECT_NEAR(natural[0] * 2 * pi * r * r, step, 1e-15);
  EXPECT_NEAR(natural[1] * r, 1, 1e-15);
  EXPECT_EQ(natural[2], 0);
}

TEST_P(PresetsTest, BendsSoftestInThePlaneOfItsNaturalCurvature) {
  const Preset preset = PresetOf(GetParam().type);
  const Eigen::Vector3d EI = rod::Stiffness(preset.section, preset.material);
  const double e = GetParam().ellipticity;
  EXPECT_NEAR(EI[2] / EI[1], e * e, 1e-12);
  EXPECT_GE(EI[2], EI[1]);
}

TEST_P(PresetsTest, FrictionLiesInThePublishedRanges) {
  const Preset preset = PresetOf(GetParam().type);
  EXPECT_GE(preset.internal_friction, 5e-11);
  EXPECT_LE(preset.internal_friction, 5e-10);
  EXPECT_GE(preset.air_drag, 5e-6);
  EXPECT_LE(preset.air_drag, 5e-5);
}

TEST(PresetStiffness, OfRoundHairIsThatOfACircle) {
  const Preset smooth = PresetOf(HairType::kAsianSmooth);
  const Eigen::Vector3d EI = rod::Stiffness(smooth.section, smooth.material);
  const double r4 = 6.25e-18;                    // (50 um)^4
  EXPECT_NEAR(EI[1], 1e9 * pi * r4 / 4, 1e-20);  // E pi r^4 / 4
  EXPECT_NEAR(EI[2], EI[1], 1e-22);
  EXPECT_NEAR(EI[0], 1e9 / (2 * 1.48) * pi * r4 / 2, 1e-20);  // mu pi r^4 / 2
  EXPECT_NEAR(rod::LinearDensity(smooth.section, smooth.material), 1300 * pi * 2.5e-9, 1e-18);
}

}  // namespace
}  // namespace mane::groom
