#include "base/check.h"

#include <fmt/format.h>

#include "base/check_failure.h"

namespace mane::base {

void FailCheck(const char* condition, const char* file, int line) {
  throw CheckFailure(fmt::format("check failed: {} ({}:{})", condition, file, line));
}

}  // namespace mane::base
