#pragma once

/// Statics, lane by lane (beam.md, B3 to B6); only for sources that define MANE_ISA.

#include "beam/bend_kernels.h"
#include "simd/lanewise.h"

namespace mane::beam {
namespace MANE_ISA {

template <typename T, int W>
constexpr BendKernels<T> MakeBend() {
  return {};
}

}  // namespace MANE_ISA
}  // namespace mane::beam
