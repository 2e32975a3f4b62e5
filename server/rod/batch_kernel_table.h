#pragma once

/// Makes the tables of one instruction set; only for batch_kernel_<isa>.cpp, which define MANE_ISA.

#include "rod/batch_sample.h"
#include "rod/batch_step.h"
#include "rod/kernels.h"

namespace mane::rod {
namespace MANE_ISA {

template <typename T, int W>
void StepBlock(int N, const T* constants, const T* drive, T* state, void* scratch, T* size) {
  using K = StrandStep<T, W>;
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    K::Step(N, constants + lane, drive + lane, state + lane,
            static_cast<typename K::Element*>(scratch), size + lane);
  }
}

template <typename T, int W>
void SampleBlock(int N, const T* constants, const T* pose, const T* state, int points,
                 T* positions) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    StrandSample<T, W>::Sample(N, constants + lane, pose + lane, state + lane, points,
                               positions + lane);
  }
}

/// The table for W lanes at a time.
template <typename T, int W>
constexpr KernelTable<T> MakeTable() {
  return {&StepBlock<T, W>, &SampleBlock<T, W>, sizeof(typename StrandStep<T, W>::Element)};
}

}  // namespace MANE_ISA
}  // namespace mane::rod
