#include "groom/range.h"

#include <fmt/format.h>

#include <utility>

namespace mane::groom {

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

Error TooMany(std::string field, std::string_view what, long count, long limit) {
  std::string message =
      fmt::format("{} asks for {} {}; this server allows at most {}", field, count, what, limit);
  return {ErrorCode::kResourceExhausted, std::move(message), std::move(field)};
}

}  // namespace mane::groom
