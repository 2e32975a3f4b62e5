#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <string>
#include <string_view>

#include "base/result.h"

namespace mane::groom {

/// The numbers that an input may be: [low, high], or (low, high] when `open_low`. Never NaN.
struct Range {
  double low;
  double high;
  const char* unit = "";  ///< For messages, such as "m".
  bool open_low = false;

  [[nodiscard]] bool Contains(double value) const {
    return (open_low ? value > low : value >= low) && value <= high;
  }
};

/// Range of coordinates [m].
inline constexpr Range kCoordinateRange{-1e6, 1e6, "m"};

/// INVALID_ARGUMENT that tells `value` and the range.
[[nodiscard]] Error OutOfRange(std::string field, double value, const Range& range);

/// OutOfRange of the first component of `v` that is, named `<field>.x`, `.y` or `.z`.
[[nodiscard]] Result<void> CheckVector(const std::string& field, const Eigen::Vector3d& v,
                                       const Range& range);

/// `q` of norm one: as it is where its squared norm is one to 1e-14, normalised where its norm is
/// within 1 % of one, else INVALID_ARGUMENT.
[[nodiscard]] Result<Eigen::Quaterniond> UnitQuaternion(const std::string& field,
                                                        const Eigen::Quaterniond& q);

/// RESOURCE_EXHAUSTED that tells `count` and the limit; `what` is the plural of what is counted.
[[nodiscard]] Error TooMany(std::string field, std::string_view what, long count, long limit);

}  // namespace mane::groom
