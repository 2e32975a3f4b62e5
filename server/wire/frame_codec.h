#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace mane::wire {

/// One strand's part of `HairFrame.data`, in each FrameFormat of proto/mane/v1/animation.proto. The
/// parts of a frame's guides follow one another without padding, so that guides can be encoded and
/// decoded in any order, by any worker. Numbers are little-endian.
///
/// In every function `data` has exactly the size that the format gives the strand; that is checked,
/// and a wrong size is a fault of the caller. Pure; no allocation.

/// Bytes of a strand of `points` points: float32 [point, 3].
[[nodiscard]] constexpr size_t PositionsSize(size_t points) { return 12 * points; }
/// Bytes of a strand of `points` points: float32 [2, 3] and uint16 [point, 3].
[[nodiscard]] constexpr size_t QuantizedSize(size_t points) { return 24 + 6 * points; }
/// Bytes of a strand of `count` coordinates, 3 an element, 4 of a wound strand: float32 [count].
[[nodiscard]] constexpr size_t CoordinatesSize(size_t count) { return 4 * count; }

/// POSITIONS_FLOAT32 of one strand's points [m].
void EncodePositions(std::span<const Eigen::Vector3f> points, std::span<std::byte> data);
void DecodePositions(std::span<const std::byte> data, std::span<Eigen::Vector3f> points);

/// POSITIONS_QUANTIZED16 of one strand's points [m], which must be finite: 16 bits an axis within
/// the strand's box. A coordinate comes back within (high - low) / 131070 of itself, and one
/// rounding to float32. Corners of the box come back exactly.
void EncodeQuantized(std::span<const Eigen::Vector3f> points, std::span<std::byte> data);
void DecodeQuantized(std::span<const std::byte> data, std::span<Eigen::Vector3f> points);

/// GENERALIZED of one strand's coordinates [rad], element by element, rounded to float32.
void EncodeCoordinates(std::span<const double> coordinates, std::span<std::byte> data);
void DecodeCoordinates(std::span<const std::byte> data, std::span<double> coordinates);

}  // namespace mane::wire
