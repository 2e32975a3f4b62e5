#pragma once

/// Makes the tables of one instruction set; only for batch_kernel_<isa>.cpp, which define MANE_ISA.

#include "rod/batch_sample.h"
#include "rod/batch_step.h"
#include "rod/batch_wound_step.h"
#include "rod/kernels.h"

namespace mane::rod {
namespace MANE_ISA {

template <typename T, typename Kernel, int W>
void StepBlock(int N, const T* constants, const T* drive, T* state, void* scratch, T* size) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    Kernel::Step(N, constants + lane, drive + lane, state + lane,
                 static_cast<typename Kernel::Element*>(scratch), size + lane);
  }
}

template <typename T, typename Walk, int W>
void SampleBlock(int N, const T* constants, const T* pose, const T* state, int points,
                 T* positions) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    Sample<T, W, Walk>(N, constants + lane, pose + lane, state + lane, points, positions + lane);
  }
}

template <typename T, typename Kernel, typename Walk, int W>
constexpr KindKernels<T> MakeKind() {
  return {&StepBlock<T, Kernel, W>, &SampleBlock<T, Walk, W>, sizeof(typename Kernel::Element)};
}

/// The table for W lanes at a time.
template <typename T, int W>
constexpr KernelTable<T> MakeTable() {
  return {MakeKind<T, StrandStep<T, W>, HelixWalk<T, W>, W>(),
          MakeKind<T, WoundStep<T, W>, CoilWalk<T, W>, W>()};
}

}  // namespace MANE_ISA
}  // namespace mane::rod
