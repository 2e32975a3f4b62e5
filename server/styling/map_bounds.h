#pragma once

#include <Eigen/Core>

#include <vector>

#include "styling/style.h"

namespace mane::styling {

/// Between which two numbers something lies.
struct Bounds {
  double low = 0;
  double high = 0;
};

/// The least and the greatest pixels of an image in any box of them, in constant time: a pyramid of
/// images of half the size each. O(pixels) to make, a fifth of the image's memory more than it.
class ImageBounds {
 public:
  /// @param image  valid; referred to.
  explicit ImageBounds(const MapImage& image);

  /// Holds for all of columns x0 to x1 and rows y0 to y1, each included and within the image. Not
  /// always the closest bounds: pixels beside the box may be in it, within half the box's longer
  /// side.
  [[nodiscard]] Bounds Over(int x0, int y0, int x1, int y1) const;

 private:
  struct Level {
    int width = 0;
    int height = 0;
    std::vector<float> low, high;
  };

  [[nodiscard]] Bounds At(int level, int x, int y) const;

  const MapImage& image_;
  std::vector<Level> levels_;  // Each a pixel for 2 x 2 of the one before, from the image on.
};

/// Bounds of a map over balls (scalp.md, P5).
class MapBounds {
 public:
  /// @param map  valid, nowhere below 0; referred to.
  explicit MapBounds(const ScalpMap& map);

  /// Holds for all points within `radius` of `from_center`, which is seen from the chart's centre
  /// [m].
  [[nodiscard]] Bounds Over(const Eigen::Vector3d& from_center, double radius) const;

 private:
  const ScalpMap& map_;
  std::vector<ImageBounds> image_;  // One, if the map has an image.
};

}  // namespace mane::styling
