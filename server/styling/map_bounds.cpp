#include "styling/map_bounds.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <span>

#include "styling/chart.h"
#include "styling/map.h"

namespace mane::styling {
namespace {

using std::numbers::pi;

constexpr double kNearBottom = 3.0;  // Polar angle beyond which images are stretched without bound.

void Include(Bounds& bounds, double value) {
  bounds.low = std::min(bounds.low, value);
  bounds.high = std::max(bounds.high, value);
}

Bounds operator*(const Bounds& a, const Bounds& b) { return {a.low * b.low, a.high * b.high}; }

// A piecewise linear function's extremes are at the ends and at the stops between.
template <typename Evaluate>
Bounds OverInterval(std::span<const Stop> stops, double x0, double x1, const Evaluate& evaluate) {
  Bounds bounds{evaluate(stops, x0), evaluate(stops, x0)};
  Include(bounds, evaluate(stops, x1));
  auto stop = std::ranges::lower_bound(stops, x0, {}, &Stop::at);
  for (; stop != stops.end() && stop->at <= x1; ++stop) Include(bounds, stop->value);
  return bounds;
}

Bounds OverPolar(std::span<const Stop> stops, double x0, double x1) {
  if (stops.empty()) return {1, 1};
  return OverInterval(stops, std::max(x0, 0.0), std::min(x1, pi), AtStops);
}

Bounds OverAzimuth(std::span<const Stop> stops, double middle, double half_width) {
  if (stops.empty()) return {1, 1};
  const double x0 = middle - half_width, x1 = middle + half_width;
  if (half_width >= pi) return OverInterval(stops, -pi, pi, AtPeriodicStops);
  if (x0 >= -pi && x1 <= pi) return OverInterval(stops, x0, x1, AtPeriodicStops);
  // Through half a turn.
  Bounds bounds = OverInterval(stops, x0 < -pi ? x0 + 2 * pi : x0, pi, AtPeriodicStops);
  const Bounds rest = OverInterval(stops, -pi, x1 > pi ? x1 - 2 * pi : x1, AtPeriodicStops);
  Include(bounds, rest.low);
  Include(bounds, rest.high);
  return bounds;
}

}  // namespace

ImageBounds::ImageBounds(const MapImage& image) : image_(image) {
  int width = image.width, height = image.height;
  while (std::max(width, height) > 1) {
    const int level = static_cast<int>(levels_.size());
    Level next{(width + 1) / 2, (height + 1) / 2, {}, {}};
    const size_t pixels = size_t(next.width) * next.height;
    next.low.reserve(pixels);
    next.high.reserve(pixels);
    for (int y = 0; y < next.height; ++y) {
      for (int x = 0; x < next.width; ++x) {
        Bounds bounds = At(level, 2 * x, 2 * y);
        for (int k = 1; k < 4; ++k) {
          const Bounds other =
              At(level, std::min(2 * x + k % 2, width - 1), std::min(2 * y + k / 2, height - 1));
          Include(bounds, other.low);
          Include(bounds, other.high);
        }
        next.low.push_back(static_cast<float>(bounds.low));
        next.high.push_back(static_cast<float>(bounds.high));
      }
    }
    width = next.width;
    height = next.height;
    levels_.push_back(std::move(next));
  }
}

Bounds ImageBounds::At(int level, int x, int y) const {
  if (level == 0) {
    const double value = image_.values[size_t(y) * image_.width + x];
    return {value, value};
  }
  const Level& l = levels_[level - 1];
  const size_t i = size_t(y) * l.width + x;
  return {l.low[i], l.high[i]};
}

Bounds ImageBounds::Over(int x0, int y0, int x1, int y1) const {
  // So that at most five pixels a side are looked at.
  const auto longer = static_cast<unsigned>(std::max(x1 - x0, y1 - y0));
  const int level = std::max(static_cast<int>(std::bit_width(longer)) - 2, 0);
  Bounds bounds = At(level, x0 >> level, y0 >> level);
  for (int y = y0 >> level; y <= y1 >> level; ++y) {
    for (int x = x0 >> level; x <= x1 >> level; ++x) {
      const Bounds other = At(level, x, y);
      Include(bounds, other.low);
      Include(bounds, other.high);
    }
  }
  return bounds;
}

MapBounds::MapBounds(const ScalpMap& map) : map_(map) {
  if (map.image) image_.emplace_back(*map.image);
}

// (P5) with its letters.
Bounds MapBounds::Over(const Eigen::Vector3d& from_center, double radius) const {
  Bounds bounds{map_.value, map_.value};
  if (map_.by_polar.empty() && map_.by_azimuth.empty() && image_.empty()) return bounds;
  const double D = from_center.norm();
  const double alpha = radius < D ? std::asin(radius / D) : pi;
  const double horizontal = std::hypot(from_center.x(), from_center.z());
  const double polar = std::atan2(horizontal, from_center.y());
  const double azimuth = std::atan2(from_center.x(), from_center.z());
  const double p0 = polar - alpha, p1 = polar + alpha;
  const bool holds_pole = p0 <= 0 || p1 >= pi;
  const double half_width =
      holds_pole ? pi : std::asin(std::min(std::sin(alpha) / std::sin(polar), 1.0));
  bounds =
      bounds * OverPolar(map_.by_polar, p0, p1) * OverAzimuth(map_.by_azimuth, azimuth, half_width);
  if (image_.empty()) return bounds;

  const int width = map_.image->width, height = map_.image->height;
  if (p1 >= kNearBottom) return bounds * image_[0].Over(0, 0, width - 1, height - 1);
  const ImagePoint middle = ToImage({polar, azimuth});
  const double reach = alpha * p1 / std::sin(p1) / (2 * pi);
  const auto pixel = [](double fraction, int size, double up) {
    return static_cast<int>(std::clamp(std::floor(fraction * size - 0.5) + up, 0.0, size - 1.0));
  };
  return bounds *
         image_[0].Over(pixel(middle.u - reach, width, 0), pixel(middle.v - reach, height, 0),
                        pixel(middle.u + reach, width, 1), pixel(middle.v + reach, height, 1));
}

}  // namespace mane::styling
