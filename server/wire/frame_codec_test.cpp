// Properties of the three frame formats:
//   round trip   float32 formats return the same bits; quantised ones stay in the stated error
//   layout       bytes are where the format's description puts them, whatever the encoder does
//   sizes        a wrong size is refused, not read past

#include "wire/frame_codec.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <random>
#include <vector>

#include "base/check_failure.h"

namespace mane::wire {
namespace {

using Eigen::Vector3f;

std::vector<Vector3f> RandomPoints(size_t count, float extent, const Vector3f& center) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<Vector3f> points(count);
  for (Vector3f& x : points) x = center + extent * Vector3f(unit(rng), unit(rng), unit(rng));
  return points;
}

// The number at byte `offset`, read as a client that knows only the description would.
template <typename Number>
Number At(const std::vector<std::byte>& data, size_t offset) {
  Number number;
  std::memcpy(&number, data.data() + offset, sizeof number);
  return number;
}

TEST(FrameCodec, PositionsComeBackBitForBit) {
  for (const size_t count : {2u, 16u, 256u}) {
    const auto points = RandomPoints(count, 0.3f, {1, 2, 3});
    std::vector<std::byte> data(PositionsSize(count));
    EncodePositions(points, data);
    std::vector<Vector3f> decoded(count);
    DecodePositions(data, decoded);
    EXPECT_EQ(decoded, points);
  }
}

TEST(FrameCodec, PositionsAreFloatsInOrderOfPointThenAxis) {
  const std::vector<Vector3f> points = {{1, 2, 3}, {4, 5, 6}};
  std::vector<std::byte> data(PositionsSize(2));
  EncodePositions(points, data);
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(At<float>(data, 4 * i), static_cast<float>(i + 1));
}

TEST(FrameCodec, QuantisedPositionsStayWithinTheStatedError) {
  for (const float extent : {1e-4f, 0.3f, 5.0f}) {
    for (const float away : {0.0f, 2.0f, 1000.0f}) {
      SCOPED_TRACE(::testing::Message() << "extent " << extent << ", away " << away);
      const auto points = RandomPoints(256, extent, {away, -away, away});
      std::vector<std::byte> data(QuantizedSize(256));
      EncodeQuantized(points, data);
      std::vector<Vector3f> decoded(256);
      DecodeQuantized(data, decoded);
      for (int axis = 0; axis < 3; ++axis) {
        const size_t a = static_cast<size_t>(axis);
        const double box = At<float>(data, 12 + 4 * a) - double(At<float>(data, 4 * a));
        const double rounding =
            0.5 * (std::nextafter(away + 2 * extent, INFINITY) - double(away + 2 * extent));
        for (size_t i = 0; i < 256; ++i) {
          EXPECT_LE(std::abs(double(decoded[i][axis]) - points[i][axis]),
                    box / 131070 * (1 + 1e-9) + rounding);
        }
      }
    }
  }
}

TEST(FrameCodec, QuantisedBoxIsTightAndItsCornersAreExact) {
  const std::vector<Vector3f> points = {{0, 5, -1}, {1, 7, -1}, {0.5f, 6, -1}};
  std::vector<std::byte> data(QuantizedSize(3));
  EncodeQuantized(points, data);
  const float box[6] = {0, 5, -1, 1, 7, -1};
  for (size_t i = 0; i < 6; ++i) EXPECT_EQ(At<float>(data, 4 * i), box[i]);
  const uint16_t steps[9] = {0, 0, 0, 65535, 65535, 0, 32768, 32768, 0};
  for (size_t i = 0; i < 9; ++i) EXPECT_EQ(At<uint16_t>(data, 24 + 2 * i), steps[i]);
  std::vector<Vector3f> decoded(3);
  DecodeQuantized(data, decoded);
  EXPECT_EQ(decoded[0], points[0]);
  EXPECT_EQ(decoded[1], points[1]);
}

TEST(FrameCodec, CoordinatesComeBackRoundedToFloat) {
  for (const size_t count : {0u, 3u, 4u, 9u}) {  // Any number: 3 or 4 an element.
    std::vector<double> coordinates(count);
    for (size_t i = 0; i < count; ++i) coordinates[i] = 12.5 - static_cast<double>(i) / 3;
    std::vector<std::byte> data(CoordinatesSize(count));
    EXPECT_EQ(data.size(), 4 * count);
    EncodeCoordinates(coordinates, data);
    std::vector<double> decoded(count);
    DecodeCoordinates(data, decoded);
    for (size_t i = 0; i < count; ++i) {
      const auto rounded = static_cast<float>(coordinates[i]);
      EXPECT_EQ(At<float>(data, 4 * i), rounded);
      EXPECT_EQ(decoded[i], rounded);
    }
  }
}

TEST(FrameCodec, RefusesDataOfTheWrongSize) {
  std::vector<std::byte> data(QuantizedSize(4) - 1);
  std::vector<Vector3f> points(4, Vector3f::Zero());
  std::vector<double> coordinates(4);
  EXPECT_THROW(EncodePositions(points, data), base::CheckFailure);
  EXPECT_THROW(DecodePositions(data, points), base::CheckFailure);
  EXPECT_THROW(EncodeQuantized(points, data), base::CheckFailure);
  EXPECT_THROW(DecodeQuantized(data, points), base::CheckFailure);
  EXPECT_THROW(EncodeCoordinates(coordinates, data), base::CheckFailure);
  EXPECT_THROW(DecodeCoordinates(data, coordinates), base::CheckFailure);
}

}  // namespace
}  // namespace mane::wire
