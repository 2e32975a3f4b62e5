#pragma once

#include <functional>

#include "base/result.h"

namespace mane::base {

/// Whether what is being made is no longer wanted. Asked from any thread, some times a second or
/// more often; must not block. Empty where it stays wanted.
using Cancelled = std::function<bool()>;

[[nodiscard]] inline bool IsCancelled(const Cancelled& cancelled) {
  return cancelled && cancelled();
}

/// What is returned then.
[[nodiscard]] inline Error CancelledError() {
  return {ErrorCode::kCancelled, "nobody waits for this any more", ""};
}

}  // namespace mane::base
