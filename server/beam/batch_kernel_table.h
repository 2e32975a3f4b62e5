#pragma once

/// The kernels of one instruction set; only for sources that define MANE_ISA.

#include "beam/bend_kernel.h"
#include "beam/kernels.h"
#include "beam/motion_kernel.h"

namespace mane::beam {
namespace MANE_ISA {

/// The table for W lanes at a time.
template <typename T, int W>
constexpr KernelTable<T> MakeTable() {
  return {MakeBend<T, W>(), MakeMotion<T, W>()};
}

}  // namespace MANE_ISA
}  // namespace mane::beam
