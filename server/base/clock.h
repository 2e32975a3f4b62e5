#pragma once

#include <chrono>

namespace mane::base {

/// Seconds on a clock that never goes back; its origin means nothing.
[[nodiscard]] inline double SteadySeconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace mane::base
