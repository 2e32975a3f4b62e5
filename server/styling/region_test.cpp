// Regions: each part alone holds where it says, parts hold together, azimuths wrap; what is wrong
// or leaves nothing is named.

#include "styling/region.h"

#include <gtest/gtest.h>

#include <limits>
#include <memory>
#include <numbers>
#include <string>

#include "math/random.h"
#include "styling/map.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

class RegionTest : public ::testing::Test {
 protected:
  bool Holds(const Region& region, const Vector3d& x, uint32_t wisp = 0) {
    return Contains(region, chart_, x, wisp);
  }
  void ExpectError(const Region& region, const std::string& field) {
    const Result<void> result = Validate(region, "selection", 10);
    ASSERT_FALSE(result) << field;
    EXPECT_EQ(result.error().field, field);
    EXPECT_NE(result.error().message.find(field), std::string::npos);
  }

  ScalpChart chart_{groom::Ellipsoid{{0, 0.5, 0}, {1, 1, 1}}};
};

TEST_F(RegionTest, NothingSetIsTheWholeScalp) {
  EXPECT_TRUE(Holds({}, {0.3, 0.2, 0.1}, 7));
  EXPECT_TRUE(Validate(Region{}, "selection", 10));
}

TEST_F(RegionTest, PolarAnglesAreAboutTheCenter) {
  Region region;
  region.polar = {0.5, pi / 2 + 1e-9};
  EXPECT_FALSE(Holds(region, {0.1, 1.5, 0}));
  EXPECT_TRUE(Holds(region, {1, 1.5, 0}));
  EXPECT_TRUE(Holds(region, {0, 0.5, -1}));
  EXPECT_FALSE(Holds(region, {0, 0.4, 1}));
}

TEST_F(RegionTest, AzimuthsWrap) {
  Region front, back;
  front.azimuth = {-pi / 4, pi / 4};
  back.azimuth = {pi / 4, -pi / 4};
  math::RandomStream random(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d x = chart_.center() + DirectionOf({1, random.Uniform(-pi, pi)});
    EXPECT_EQ(Holds(front, x), x.z() > std::abs(x.x()));
    EXPECT_EQ(Holds(back, x), !Holds(front, x));
  }
  EXPECT_TRUE(Holds(back, {0, 0.5, -1}));
  EXPECT_TRUE(Holds(back, {-1e-12, 0.5, -1}));
}

TEST_F(RegionTest, HalfSpacesHoldTogether) {
  Region region;
  region.half_spaces = {{{0, 2, 0}, 0.3}, {{1, 0, 0}, -0.1}};  // Normals count as directions.
  EXPECT_TRUE(Holds(region, {0, 0.31, 0}));
  EXPECT_FALSE(Holds(region, {0, 0.29, 0}));
  EXPECT_FALSE(Holds(region, {-0.2, 0.5, 0}));
}

TEST_F(RegionTest, MasksArePaintedFromAbove) {
  Region region;
  auto mask = std::make_shared<MapImage>(MapImage{2, 1, {0, 1}});  // Right half: +X.
  region.mask = mask;
  EXPECT_TRUE(Holds(region, {0.1, 0.5, 0}));
  EXPECT_FALSE(Holds(region, {-0.1, 0.5, 0}));
}

TEST_F(RegionTest, WispsByNumber) {
  Region region;
  region.wisps = {2, 3, 9};
  for (uint32_t wisp = 0; wisp < 10; ++wisp) {
    EXPECT_EQ(Holds(region, {0, 0, 0}, wisp), wisp == 2 || wisp == 3 || wisp == 9);
  }
}

TEST_F(RegionTest, AllPartsMustHold) {
  Region region;
  region.polar = {0, 2};
  region.azimuth = {-1, 1};
  region.half_spaces = {{{0, 1, 0}, 0}};
  region.mask = std::make_shared<MapImage>(MapImage{1, 1, {1}});
  region.wisps = {4};
  ASSERT_TRUE(Validate(region, "selection", 10));
  const Vector3d x(0, 0.6, 1);
  EXPECT_TRUE(Holds(region, x, 4));
  EXPECT_FALSE(Holds(region, x, 5));
  EXPECT_FALSE(Holds(region, {0, 0.6, -1}, 4));
  EXPECT_FALSE(Holds(region, {0, -0.1, 1}, 4));
  EXPECT_FALSE(Holds(region, {0, 0.01, 0.1}, 4));
}

TEST_F(RegionTest, WhatIsWrongOrLeavesNothingIsNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Region region;
  region.polar = {1, 0.5};
  ExpectError(region, "selection.polar");
  region.polar = {0, 4};
  ExpectError(region, "selection.polar.high");
  region.polar = {nan, 1};
  ExpectError(region, "selection.polar.low");
  region = {};
  region.azimuth = {1, 1};
  ExpectError(region, "selection.azimuth");
  region.azimuth = {pi, -pi};
  ExpectError(region, "selection.azimuth");
  region.azimuth = {-4, 1};
  ExpectError(region, "selection.azimuth.low");
  region = {};
  region.half_spaces = {{{0, 0, 0}, 0}};
  ExpectError(region, "selection.half_spaces[0].normal");
  region.half_spaces = {{{0, 1, 0}, nan}};
  ExpectError(region, "selection.half_spaces[0].offset_m");
  region.half_spaces = {{{0, 1, 0}, 0.1}, {{0, -3, 0}, -0.05}};
  ExpectError(region, "selection.half_spaces[1]");
  region.half_spaces[1].offset = -0.15;
  EXPECT_TRUE(Validate(region, "selection", 10));
  region = {};
  region.mask = std::make_shared<MapImage>(MapImage{2, 1, {0.5f, 0.2f}});
  ExpectError(region, "selection.mask_png");
  region.mask = std::make_shared<MapImage>(MapImage{2, 1, {0.5f}});
  ExpectError(region, "selection.mask_png.values");
  region = {};
  region.wisps = {3, 10};
  ExpectError(region, "selection.wisps[1]");
  region.wisps = {3, 3};
  ExpectError(region, "selection.wisps[1]");
}

}  // namespace
}  // namespace mane::styling
