#pragma once

/// Dynamics, lane by lane (beam.md, B7 to B15); only for sources that define MANE_ISA.

#include "beam/motion_kernels.h"
#include "simd/lanewise.h"

namespace mane::beam {
namespace MANE_ISA {

template <typename T, int W>
constexpr MotionKernels<T> MakeMotion() {
  return {};
}

}  // namespace MANE_ISA
}  // namespace mane::beam
