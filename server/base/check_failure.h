#pragma once

#include <stdexcept>

namespace mane::base {

/// A fault of this program, found by MANE_CHECK. Caught only where work is isolated.
class CheckFailure : public std::logic_error {
 public:
  using std::logic_error::logic_error;
};

}  // namespace mane::base
