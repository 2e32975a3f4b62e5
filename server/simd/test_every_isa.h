#pragma once

#include <gtest/gtest.h>

#include <string>

#include "simd/isa.h"

namespace mane::simd::fixtures {

/// A typed test of kernels, `kKernelsFor(isa)` being those of a number type.
template <auto kKernelsFor>
class EveryIsaTest : public testing::Test {
 protected:
  /// Calls check(kernels) for every instruction set of this machine.
  template <typename Check>
  void ForEveryIsa(const Check& check) {
    for (const Isa isa : Supported()) {
      SCOPED_TRACE(std::string(Name(isa)));
      check(kKernelsFor(isa));
    }
  }
};

/// Both number types.
using Numbers = testing::Types<float, double>;

}  // namespace mane::simd::fixtures
