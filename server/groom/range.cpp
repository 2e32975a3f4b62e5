#include "groom/range.h"

#include <fmt/format.h>

#include <cmath>
#include <utility>

namespace mane::groom {
namespace {

constexpr double kNormTolerance = 1e-2;  // Of quaternions.
constexpr double kUnitTolerance = 1e-14;

}  // namespace

Error OutOfRange(std::string field, double value, const Range& range) {
  std::string message = fmt::format("{} is {}; it must lie in {}{:g}, {:g}]{}{}", field, value,
                                    range.open_low ? '(' : '[', range.low, range.high,
                                    *range.unit ? " " : "", range.unit);
  return InvalidArgument(std::move(field), std::move(message));
}

Result<void> CheckVector(const std::string& field, const Eigen::Vector3d& v, const Range& range) {
  constexpr const char* kAxes[] = {".x", ".y", ".z"};
  for (int k = 0; k < 3; ++k) {
    if (!range.Contains(v[k])) return OutOfRange(field + kAxes[k], v[k], range);
  }
  return {};
}

Result<Eigen::Quaterniond> UnitQuaternion(const std::string& field, const Eigen::Quaterniond& q) {
  const double norm = q.norm();
  if (!(std::abs(norm - 1) <= kNormTolerance)) {
    return InvalidArgument(
        field, fmt::format("{} is ({}, {}, {}, {}) of norm {}; the norm must be within 1 % of 1",
                           field, q.x(), q.y(), q.z(), q.w(), norm));
  }
  return std::abs(q.squaredNorm() - 1) <= kUnitTolerance ? q : q.normalized();
}

Error TooMany(std::string field, std::string_view what, long count, long limit) {
  std::string message =
      fmt::format("{} asks for {} {}; this server allows at most {}", field, count, what, limit);
  return {ErrorCode::kResourceExhausted, std::move(message), std::move(field)};
}

}  // namespace mane::groom
