#pragma once

#include "beam/bend_kernels.h"
#include "beam/motion_kernels.h"
#include "simd/isa.h"

namespace mane::beam {

/// The batched kernels of one instruction set, for numbers of type T (float or double). Pure
/// functions of their arguments: each lane's result depends on nothing in other lanes.
template <typename T>
struct KernelTable {
  BendKernels<T> bend;
  MotionKernels<T> motion;
};

/// Kernels for an instruction set that simd::Supported() lists.
template <typename T>
[[nodiscard]] const KernelTable<T>& KernelsFor(simd::Isa isa);

}  // namespace mane::beam
