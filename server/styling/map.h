#pragma once

#include <span>
#include <string>

#include "base/result.h"
#include "styling/chart.h"
#include "styling/style.h"

namespace mane::styling {

inline constexpr int kLargestImage = 4096;     ///< Pixels of a side of a MapImage.
inline constexpr double kLargestFactor = 1e6;  ///< Value of a stop.

/// Piecewise linear through `stops`, constant beyond them; 1 without stops.
[[nodiscard]] double AtStops(std::span<const Stop> stops, double x);

/// The same of an azimuth in (-pi, pi], linear from the last stop through pi to the first.
[[nodiscard]] double AtPeriodicStops(std::span<const Stop> stops, double azimuth);

/// Bilinear between the middles of pixels, constant beyond the outermost (scalp.md, P4).
[[nodiscard]] double AtPixel(const MapImage& image, const ImagePoint& point);

/// Value of a valid map in a direction: the product of what is set.
[[nodiscard]] double ValueAt(const ScalpMap& map, const Angles& angles);

/// INVALID_ARGUMENT where sizes are out of range or do not match, or a value lies outside [0, 1].
[[nodiscard]] Result<void> Validate(const MapImage& image, const std::string& field);

/// INVALID_ARGUMENT that names a part of `field`, where not
///   - `value` lies in [low, high];
///   - stops increase, in [0, pi] and [-pi, pi], and their values lie in [0, kLargestFactor];
///   - `image` is valid;
///   - the product stays below `high`. It may fall below `low`: down to 0, where a factor is 0.
[[nodiscard]] Result<void> Validate(const ScalpMap& map, const std::string& field, double low,
                                    double high);

/// A map as an image to look at, or to paint on.
struct Painting {
  MapImage image;    ///< The map over `scale`.
  double scale = 0;  ///< The map's greatest value in the image.
};

/// Draws a valid map that is nowhere below 0, in an image of `size` x `size` pixels, 1 to
/// kLargestImage. ScalpMap{.value = scale, .image = image} is that map again, up to what an image
/// of this size can show.
[[nodiscard]] Painting Paint(const ScalpMap& map, int size);

}  // namespace mane::styling
