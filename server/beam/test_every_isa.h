#pragma once

#include <gtest/gtest.h>

#include <string>

#include "beam/kernels.h"

namespace mane::beam::fixtures {

/// A typed test of the kernels of a number type.
template <typename T>
class EveryIsaTest : public testing::Test {
 protected:
  /// Calls check(kernels) for every instruction set of this machine.
  template <typename Check>
  void ForEveryIsa(const Check& check) {
    for (const simd::Isa isa : simd::Supported()) {
      SCOPED_TRACE(std::string(simd::Name(isa)));
      check(KernelsFor<T>(isa));
    }
  }
};

/// Both number types.
using Numbers = testing::Types<float, double>;

}  // namespace mane::beam::fixtures
