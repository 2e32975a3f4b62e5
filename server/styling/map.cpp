#include "styling/map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"
#include "groom/range.h"

namespace mane::styling {
namespace {

using groom::OutOfRange;
using std::numbers::pi;

double Between(const Stop& a, const Stop& b, double x) {
  const double t = (x - a.at) / (b.at - a.at);
  return (1 - t) * a.value + t * b.value;
}

Result<void> CheckStops(std::span<const Stop> stops, const std::string& field,
                        const groom::Range& places) {
  const groom::Range values{0, kLargestFactor};
  for (size_t i = 0; i < stops.size(); ++i) {
    const std::string at = fmt::format("{}[{}].at", field, i);
    if (!places.Contains(stops[i].at)) return OutOfRange(at, stops[i].at, places);
    if (i > 0 && stops[i].at <= stops[i - 1].at) {
      return InvalidArgument(
          at, fmt::format("{} is {}; it must be above {}, that of the one before", at, stops[i].at,
                          stops[i - 1].at));
    }
    if (values.Contains(stops[i].value)) continue;
    return OutOfRange(fmt::format("{}[{}].value", field, i), stops[i].value, values);
  }
  return {};
}

double Greatest(std::span<const Stop> stops) {
  if (stops.empty()) return 1;
  return std::ranges::max(stops, {}, &Stop::value).value;
}

}  // namespace

double AtStops(std::span<const Stop> stops, double x) {
  if (stops.empty()) return 1;
  const auto next = std::ranges::upper_bound(stops, x, {}, &Stop::at);
  if (next == stops.begin()) return next->value;
  if (next == stops.end()) return stops.back().value;
  return Between(*(next - 1), *next, x);
}

double AtPeriodicStops(std::span<const Stop> stops, double azimuth) {
  if (stops.empty()) return 1;
  const Stop& first = stops.front();
  const Stop& last = stops.back();
  if (azimuth >= first.at && azimuth <= last.at) return AtStops(stops, azimuth);
  const Stop wrapped{first.at + 2 * pi, first.value};
  return Between(last, wrapped, azimuth < first.at ? azimuth + 2 * pi : azimuth);
}

double AtPixel(const MapImage& image, const ImagePoint& point) {
  const double x = std::clamp(point.u * image.width - 0.5, 0.0, image.width - 1.0);
  const double y = std::clamp(point.v * image.height - 0.5, 0.0, image.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, image.width - 1), y1 = std::min(y0 + 1, image.height - 1);
  const double s = x - x0, t = y - y0;
  const float* upper = image.values.data() + size_t(y0) * image.width;
  const float* lower = image.values.data() + size_t(y1) * image.width;
  return (1 - t) * ((1 - s) * upper[x0] + s * upper[x1]) +
         t * ((1 - s) * lower[x0] + s * lower[x1]);
}

double ValueAt(const ScalpMap& map, const Angles& angles) {
  double value = map.value * AtStops(map.by_polar, angles.polar) *
                 AtPeriodicStops(map.by_azimuth, angles.azimuth);
  if (map.image) value *= AtPixel(*map.image, ToImage(angles));
  return value;
}

Result<void> Validate(const MapImage& image, const std::string& field) {
  const groom::Range sizes{1, kLargestImage, "pixels"}, values{0, 1};
  if (!sizes.Contains(image.width)) return OutOfRange(field + ".width", image.width, sizes);
  if (!sizes.Contains(image.height)) return OutOfRange(field + ".height", image.height, sizes);
  const size_t pixels = size_t(image.width) * image.height;
  if (image.values.size() != pixels) {
    return InvalidArgument(field + ".values",
                           fmt::format("{}.values has {} values; it must have {}", field,
                                       image.values.size(), pixels));
  }
  for (size_t i = 0; i < pixels; ++i) {
    if (values.Contains(image.values[i])) continue;
    return OutOfRange(fmt::format("{}.values[{}]", field, i), image.values[i], values);
  }
  return {};
}

Result<void> Validate(const ScalpMap& map, const std::string& field, double low, double high) {
  const groom::Range range{low, high};
  if (!range.Contains(map.value)) return OutOfRange(field + ".value", map.value, range);
  if (auto ok = CheckStops(map.by_polar, field + ".by_polar", {0, pi, "rad"}); !ok) return ok;
  if (auto ok = CheckStops(map.by_azimuth, field + ".by_azimuth", {-pi, pi, "rad"}); !ok) return ok;
  double greatest = map.value * Greatest(map.by_polar) * Greatest(map.by_azimuth);
  if (map.image) {
    if (auto ok = Validate(*map.image, field + ".png"); !ok) return ok;
    greatest *= std::ranges::max(map.image->values);
  }
  if (greatest <= high) return {};
  return InvalidArgument(
      field, fmt::format("{}'s factors take it to {}; it must not pass {}", field, greatest, high));
}

Painting Paint(const ScalpMap& map, int size) {
  MANE_CHECK(size >= 1 && size <= kLargestImage);
  Painting painting{{size, size, std::vector<float>(size_t(size) * size)}};
  std::vector<float>& values = painting.image.values;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      const double value = ValueAt(map, FromImage({(x + 0.5) / size, (y + 0.5) / size}));
      MANE_CHECK(value >= 0);
      values[size_t(y) * size + x] = static_cast<float>(value);
    }
  }
  const float greatest = std::ranges::max(values);
  painting.scale = greatest;
  if (greatest == 0) return painting;
  for (float& value : values) value /= greatest;
  return painting;
}

}  // namespace mane::styling
