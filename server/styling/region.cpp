#include "styling/region.h"

#include <fmt/format.h>

#include <algorithm>
#include <numbers>

#include "groom/range.h"
#include "styling/map.h"

namespace mane::styling {
namespace {

using std::numbers::pi;

constexpr size_t kMostHalfSpaces = 64;
constexpr float kInMask = 0.5f;  // Above it.

// The interval's part on the circle, low > high going through pi.
bool Holds(const Region::Interval& azimuth, double angle) {
  if (azimuth.low <= azimuth.high) return angle >= azimuth.low && angle <= azimuth.high;
  return angle >= azimuth.low || angle <= azimuth.high;
}

Result<void> CheckInterval(const Region::Interval& interval, const std::string& field,
                           const groom::Range& range) {
  if (!range.Contains(interval.low)) return OutOfRange(field + ".low", interval.low, range);
  if (!range.Contains(interval.high)) return OutOfRange(field + ".high", interval.high, range);
  return {};
}

Result<void> CheckIntervals(const Region& region, const std::string& field) {
  if (region.polar) {
    const std::string path = field + ".polar";
    if (auto ok = CheckInterval(*region.polar, path, {0, pi, "rad"}); !ok) return ok;
    if (!(region.polar->low < region.polar->high)) {
      return InvalidArgument(
          path, fmt::format("{} from {} to {} rad is empty; low must be below high", path,
                            region.polar->low, region.polar->high));
    }
  }
  if (region.azimuth) {
    const std::string path = field + ".azimuth";
    if (auto ok = CheckInterval(*region.azimuth, path, {-pi, pi, "rad"}); !ok) return ok;
    const auto [low, high] = *region.azimuth;
    if (low == high || (low == pi && high == -pi)) {
      return InvalidArgument(
          path, fmt::format("{} from {} to {} rad is empty; leave it out for all directions", path,
                            low, high));
    }
  }
  return {};
}

// Two that face each other with nothing between contradict; more that do so only together do not
// show here.
Result<void> CheckHalfSpaces(const Region& region, const std::string& field) {
  const auto& all = region.half_spaces;
  if (all.size() > kMostHalfSpaces) {
    return groom::TooMany(field, "half-spaces", std::ssize(all), kMostHalfSpaces);
  }
  for (size_t i = 0; i < all.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", field, i);
    const groom::Range lengths{1e-6, 1e6};
    if (!lengths.Contains(all[i].normal.norm())) {
      return OutOfRange(path + ".normal", all[i].normal.norm(), lengths);
    }
    if (!groom::kCoordinateRange.Contains(all[i].offset)) {
      return OutOfRange(path + ".offset_m", all[i].offset, groom::kCoordinateRange);
    }
    for (size_t j = 0; j < i; ++j) {
      const double cosine = all[i].normal.normalized().dot(all[j].normal.normalized());
      if (cosine > -1 + 1e-12 || all[i].offset + all[j].offset <= 0) continue;
      return InvalidArgument(path,
                             fmt::format("{} and {}[{}] have no point in common", path, field, j));
    }
  }
  return {};
}

Result<void> CheckMask(const MapImage& mask, const std::string& field) {
  if (auto ok = Validate(mask, field); !ok) return ok;
  const float greatest = std::ranges::max(mask.values);
  if (greatest > kInMask) return {};
  return InvalidArgument(field, fmt::format("{} reaches {} only; above {} is in the region", field,
                                            greatest, kInMask));
}

Result<void> CheckWisps(const Region& region, const std::string& field, int wisp_count) {
  for (size_t i = 0; i < region.wisps.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", field, i);
    const uint32_t wisp = region.wisps[i];
    if (wisp >= uint32_t(wisp_count)) {
      return InvalidArgument(path,
                             fmt::format("{} names wisp {}; there are {}", path, wisp, wisp_count));
    }
    if (i > 0 && wisp <= region.wisps[i - 1]) {
      return InvalidArgument(path, fmt::format("{} names wisp {} after {}; numbers must increase",
                                               path, wisp, region.wisps[i - 1]));
    }
  }
  return {};
}

}  // namespace

bool Contains(const Region& region, const ScalpChart& chart, const Eigen::Vector3d& point,
              uint32_t wisp) {
  if (!region.wisps.empty() && !std::ranges::binary_search(region.wisps, wisp)) return false;
  for (const Region::HalfSpace& half : region.half_spaces) {
    if (half.normal.normalized().dot(point) < half.offset) return false;
  }
  if (!region.polar && !region.azimuth && !region.mask) return true;
  const Angles angles = chart.At(point);
  if (region.polar && (angles.polar < region.polar->low || angles.polar > region.polar->high)) {
    return false;
  }
  if (region.azimuth && !Holds(*region.azimuth, angles.azimuth)) return false;
  return !region.mask || AtPixel(*region.mask, ToImage(angles)) > kInMask;
}

Result<void> Validate(const Region& region, const std::string& field, int wisp_count) {
  if (auto ok = CheckIntervals(region, field); !ok) return ok;
  if (auto ok = CheckHalfSpaces(region, field + ".half_spaces"); !ok) return ok;
  if (region.mask) {
    if (auto ok = CheckMask(*region.mask, field + ".mask_png"); !ok) return ok;
  }
  return CheckWisps(region, field + ".wisps", wisp_count);
}

}  // namespace mane::styling
