#pragma once

namespace mane::base {

/// Throws CheckFailure; the border that runs the work (a job, a head's step) turns it into
/// ErrorCode::kInternal, so that the work fails alone.
[[noreturn]] void FailCheck(const char* condition, const char* file, int line);

}  // namespace mane::base

/// States what this program guarantees about itself; never for input. Always on.
#define MANE_CHECK(condition) \
  ((condition) ? void(0) : ::mane::base::FailCheck(#condition, __FILE__, __LINE__))
