// Maps:
//   stops     linear between, constant beyond; of azimuths through half a turn without a jump
//   image     bilinear: exact of linear ramps; pixels at their middles; constant at the border
//   product   of all that is set
//   painting  the painted map is the map, as far as a picture can show it, also through PNG
//   checks    each wrong number is named

#include "styling/map.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "math/random.h"
#include "styling/png_image.h"

namespace mane::styling {
namespace {

using std::numbers::pi;

const std::vector<Stop> kStops{{0.5, 1}, {1, 3}, {2, 0}};

std::shared_ptr<MapImage> Image(int width, int height, float value) {
  return std::make_shared<MapImage>(
      MapImage{width, height, std::vector<float>(size_t(width) * height, value)});
}

TEST(MapTest, StopsAreLinearBetweenAndConstantBeyond) {
  EXPECT_EQ(AtStops({}, 7), 1);
  EXPECT_EQ(AtStops(std::vector<Stop>{{1, 5}}, 0), 5);
  const double expected[][2] = {{0, 1}, {0.5, 1}, {0.75, 2}, {1, 3}, {1.5, 1.5}, {2, 0}, {3, 0}};
  for (const auto& [x, value] : expected) EXPECT_NEAR(AtStops(kStops, x), value, 1e-15) << x;
}

TEST(MapTest, AzimuthsAreLinearThroughHalfATurn) {
  EXPECT_EQ(AtPeriodicStops({}, 3), 1);
  EXPECT_EQ(AtPeriodicStops(std::vector<Stop>{{1, 5}}, -3), 5);
  const std::vector<Stop> stops{{-3 * pi / 4, 1}, {0, 0}, {3 * pi / 4, 3}};
  // A quarter turn from 3 to 1 around the back.
  EXPECT_NEAR(AtPeriodicStops(stops, pi), 2, 1e-15);
  EXPECT_NEAR(AtPeriodicStops(stops, 7 * pi / 8), 2.5, 1e-15);
  EXPECT_NEAR(AtPeriodicStops(stops, -7 * pi / 8), 1.5, 1e-15);
  EXPECT_NEAR(AtPeriodicStops(stops, -pi + 1e-9), 2, 1e-8);
  EXPECT_NEAR(AtPeriodicStops(stops, 3 * pi / 8), 1.5, 1e-15);
  const std::vector<Stop> whole{{-pi, 4}, {pi, 2}};
  EXPECT_NEAR(AtPeriodicStops(whole, 0), 3, 1e-15);
  EXPECT_EQ(AtPeriodicStops(whole, pi), 2);
}

TEST(MapTest, ImagesAreBilinear) {
  constexpr int kWidth = 7, kHeight = 5;
  auto ramp = Image(kWidth, kHeight, 0);
  const auto plane = [](double x, double y) { return 0.05 + 0.1 * x + 0.04 * y; };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) ramp->values[y * kWidth + x] = float(plane(x, y));
  }
  math::RandomStream random(1, 0);
  for (int i = 0; i < 1000; ++i) {
    const double x = random.Uniform(-0.5, kWidth - 0.5), y = random.Uniform(-0.5, kHeight - 0.5);
    const double inside_x = std::clamp(x, 0.0, kWidth - 1.0);
    const double inside_y = std::clamp(y, 0.0, kHeight - 1.0);
    EXPECT_NEAR(AtPixel(*ramp, {(x + 0.5) / kWidth, (y + 0.5) / kHeight}),
                plane(inside_x, inside_y), 1e-6);
  }
  EXPECT_NEAR(AtPixel(*ramp, {-3, 9}), plane(0, kHeight - 1), 1e-6);
}

TEST(MapTest, AMapIsTheProductOfItsParts) {
  ScalpMap map{0.5, kStops, {{0, 2}}, Image(2, 2, 0.25)};
  EXPECT_NEAR(ValueAt(map, {0.75, 1}), 0.5 * 2 * 2 * 0.25, 1e-15);
  EXPECT_EQ(ValueAt({}, {0.75, 1}), 1);
}

// A painted forehead is at the bottom of the image.
TEST(MapTest, TheForeheadIsPaintedAtTheBottom) {
  auto image = Image(100, 100, 0);
  for (int x = 0; x < 100; ++x) image->values[75 * 100 + x] = image->values[74 * 100 + x] = 1;
  ScalpMap map;
  map.image = image;
  EXPECT_NEAR(ValueAt(map, {pi / 2, 0}), 1, 1e-6);
  EXPECT_EQ(ValueAt(map, {pi / 2, pi}), 0);
  EXPECT_EQ(ValueAt(map, {pi / 2, pi / 2}), 0);
}

TEST(MapTest, APaintedMapIsTheMap) {
  constexpr int kSize = 512;
  const ScalpMap map{0.3, {{0, 1}, {1, 2}, {2.5, 0.5}}, {{-2, 1}, {0, 0.5}, {2, 1}}, nullptr};
  const Painting painting = Paint(map, kSize);
  ASSERT_TRUE(Validate(painting.image, "painting"));
  EXPECT_LE(painting.scale, 0.6);
  EXPECT_EQ(std::ranges::max(painting.image.values), 1);
  const std::string png = EncodePng(painting.image);
  const Result<MapImage> image = DecodePng(std::as_bytes(std::span(png)), "map");
  ASSERT_TRUE(image);
  const ScalpMap painted{painting.scale, {}, {}, std::make_shared<MapImage>(*image)};
  math::RandomStream random(2, 0);
  for (int i = 0; i < 20000; ++i) {
    const Angles angles{random.Uniform(0.1, 3.1), random.Uniform(-pi, pi)};
    // Within a pixel, 2 pi / kSize = 0.012 rad, the map's slopes change by less than 1 per rad of
    // polar angle and 0.5 of azimuth, which is 1 / polar times as long; a kink of slope k is cut
    // off by up to k times a pixel.
    const double pixel = 2 * pi / kSize;
    EXPECT_NEAR(ValueAt(painted, angles), ValueAt(map, angles), pixel * (0.6 + 0.6 / angles.polar))
        << angles.polar << " " << angles.azimuth;
  }
}

TEST(MapTest, PaintingNothingIsBlack) {
  ScalpMap map;
  map.value = 0;
  const Painting painting = Paint(map, 8);
  EXPECT_EQ(painting.scale, 0);
  EXPECT_EQ(std::ranges::max(painting.image.values), 0);
}

void ExpectError(const ScalpMap& map, const std::string& field) {
  const Result<void> result = Validate(map, "length", 0.1, 2);
  ASSERT_FALSE(result) << field;
  EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(result.error().field, field);
}

TEST(MapTest, WrongNumbersAreNamed) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(Validate(ScalpMap{}, "length", 0.1, 2));
  EXPECT_TRUE(
      Validate({1, {{0, 2}, {pi, 0}}, {{-pi, 1}, {pi, 1}}, Image(2, 3, 1)}, "length", 0.1, 2));
  ExpectError({nan, {}, {}, {}}, "length.value");
  ExpectError({2.1, {}, {}, {}}, "length.value");
  ExpectError({0, {}, {}, {}}, "length.value");
  ExpectError({1, {{nan, 1}}, {}, {}}, "length.by_polar[0].at");
  ExpectError({1, {{-0.1, 1}}, {}, {}}, "length.by_polar[0].at");
  ExpectError({1, {{0, 1}, {1, 1}, {1, 2}}, {}, {}}, "length.by_polar[2].at");
  ExpectError({1, {{0, -1}}, {}, {}}, "length.by_polar[0].value");
  ExpectError({1, {{0, nan}}, {}, {}}, "length.by_polar[0].value");
  ExpectError({1, {}, {{-3.2, 1}}, {}}, "length.by_azimuth[0].at");
  ExpectError({1, {}, {{1, 1}, {0, 1}}, {}}, "length.by_azimuth[1].at");
  ExpectError({1, {{0, 1.5}}, {{0, 1.5}}, {}}, "length");
  ExpectError({1, {}, {}, Image(0, 3, 0)}, "length.png.width");
  ExpectError({1, {}, {}, Image(3, 4097, 0)}, "length.png.height");
  auto image = Image(3, 3, 0);
  image->values[4] = float(nan);
  ExpectError({1, {}, {}, image}, "length.png.values[4]");
  image->values[4] = 1.01f;
  ExpectError({1, {}, {}, image}, "length.png.values[4]");
  image->values.pop_back();
  ExpectError({1, {}, {}, image}, "length.png.values");
}

}  // namespace
}  // namespace mane::styling
