#pragma once

#include <cmath>
#include <string>

#include "base/result.h"

namespace mane::rpc {

/// Uploading calls that may be under way at once.
inline constexpr int kMaxUploads = 16;
/// How long an upload may wait for its client's next message [s].
inline constexpr double kMaxUploadIdle = 30;

/// kInvalidArgument unless low <= value <= high; NaN is outside every range.
inline Result<void> CheckRange(const std::string& field, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return InvalidArgument(
      field, fmt::format("{} is {}; it must be between {} and {}", field, value, low, high));
}

}  // namespace mane::rpc
