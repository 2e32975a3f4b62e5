#include "wire/frame_codec.h"

#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>

#include "base/check.h"

namespace mane::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are copied as they are");
static_assert(sizeof(Eigen::Vector3f) == 12, "points are copied as they are");

constexpr double kSteps = 65535;
constexpr size_t kBoxSize = 24;

struct Box {
  Eigen::Vector3f low, high;
};

}  // namespace

void EncodePositions(std::span<const Eigen::Vector3f> points, std::span<std::byte> data) {
  MANE_CHECK(data.size() == PositionsSize(points.size()));
  if (!points.empty()) std::memcpy(data.data(), points.data()->data(), data.size());
}

void DecodePositions(std::span<const std::byte> data, std::span<Eigen::Vector3f> points) {
  MANE_CHECK(data.size() == PositionsSize(points.size()));
  if (!points.empty()) std::memcpy(points.data()->data(), data.data(), data.size());
}

void EncodeQuantized(std::span<const Eigen::Vector3f> points, std::span<std::byte> data) {
  MANE_CHECK(!points.empty() && data.size() == QuantizedSize(points.size()));
  Box box{points[0], points[0]};
  for (const Eigen::Vector3f& x : points) {
    box.low = box.low.cwiseMin(x);
    box.high = box.high.cwiseMax(x);
  }
  std::memcpy(data.data(), box.low.data(), kBoxSize / 2);
  std::memcpy(data.data() + kBoxSize / 2, box.high.data(), kBoxSize / 2);

  const Eigen::Vector3d low = box.low.cast<double>();
  const Eigen::Vector3d extent = box.high.cast<double>() - low;
  std::byte* out = data.data() + kBoxSize;
  for (const Eigen::Vector3f& x : points) {
    uint16_t u[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double part = extent[axis] > 0 ? (x[axis] - low[axis]) / extent[axis] : 0;
      u[axis] = static_cast<uint16_t>(std::lround(kSteps * part));
    }
    std::memcpy(out, u, sizeof u);
    out += sizeof u;
  }
}

void DecodeQuantized(std::span<const std::byte> data, std::span<Eigen::Vector3f> points) {
  MANE_CHECK(data.size() == QuantizedSize(points.size()));
  Box box;
  std::memcpy(box.low.data(), data.data(), kBoxSize / 2);
  std::memcpy(box.high.data(), data.data() + kBoxSize / 2, kBoxSize / 2);
  const Eigen::Vector3d low = box.low.cast<double>();
  const Eigen::Vector3d extent = box.high.cast<double>() - low;
  const std::byte* in = data.data() + kBoxSize;
  for (Eigen::Vector3f& x : points) {
    uint16_t u[3];
    std::memcpy(u, in, sizeof u);
    in += sizeof u;
    for (int axis = 0; axis < 3; ++axis) {
      x[axis] = static_cast<float>(low[axis] + extent[axis] * u[axis] / kSteps);
    }
  }
}

void EncodeCoordinates(std::span<const double> coordinates, std::span<std::byte> data) {
  MANE_CHECK(data.size() == CoordinatesSize(coordinates.size()));
  std::byte* out = data.data();
  for (const double coordinate : coordinates) {
    const auto rounded = static_cast<float>(coordinate);
    std::memcpy(out, &rounded, sizeof rounded);
    out += sizeof rounded;
  }
}

void DecodeCoordinates(std::span<const std::byte> data, std::span<double> coordinates) {
  MANE_CHECK(data.size() == CoordinatesSize(coordinates.size()));
  const std::byte* in = data.data();
  for (double& coordinate : coordinates) {
    float rounded;
    std::memcpy(&rounded, in, sizeof rounded);
    coordinate = rounded;
    in += sizeof rounded;
  }
}

}  // namespace mane::wire
