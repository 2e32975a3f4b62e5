#pragma once

/// Makes the tables of one instruction set; only for batch_kernel_<isa>.cpp, which define MANE_ISA.

#include "rod/batch_loads.h"
#include "rod/batch_sample.h"
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

// What `approach` leaves of W lanes: their elements, then the shapes of their points.
template <typename Kernel>
struct ApproachScratch {
  using Element = typename Kernel::Element;
  using PointShape = typename Kernel::PointShape;

  static constexpr size_t Bytes(int N, int points) {
    return N * sizeof(Element) + points * sizeof(PointShape);
  }
  ApproachScratch(void* scratch, int N, int points, int group)
      : elements(
            reinterpret_cast<Element*>(static_cast<char*>(scratch) + group * Bytes(N, points))),
        shapes(reinterpret_cast<PointShape*>(elements + N)) {}

  Element* elements;
  PointShape* shapes;
};

template <typename T, typename Kernel, int W>
void ApproachBlock(int N, const int* first_point, const T* constants, const T* drive,
                   const T* state, void* scratch, T* points) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    const ApproachScratch<Kernel> own(scratch, N, first_point[N], lane / W);
    Kernel::Approach(N, first_point, constants + lane, drive + lane, state + lane, own.elements,
                     own.shapes, points + lane);
  }
}

template <typename T, typename Kernel, int W>
void SolveBlock(int N, const int* first_point, const T* constants, const T* drive, const T* state,
                const T* loads, const unsigned char* loaded, const unsigned char* watched,
                void* scratch, T* next, T* velocities, T* size, T* turning) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    const ApproachScratch<Kernel> own(scratch, N, first_point[N], lane / W);
    Kernel::Solve(N, first_point, constants + lane, drive + lane, state + lane, loads + lane,
                  loaded, watched, own.elements, own.shapes, next + lane, velocities + lane,
                  size + lane, turning + lane);
  }
}

template <typename Kernel, int W>
size_t ApproachBytes(int N, int points) {
  return layout::kLanes / W * ApproachScratch<Kernel>::Bytes(N, points);
}

template <typename T, typename Kernel, typename Walk, int W>
constexpr KindKernels<T> MakeKind() {
  return {&StepBlock<T, Kernel, W>,     &SampleBlock<T, Walk, W>,  sizeof(typename Kernel::Element),
          &ApproachBlock<T, Kernel, W>, &SolveBlock<T, Kernel, W>, &ApproachBytes<Kernel, W>};
}

/// The table for W lanes at a time.
template <typename T, int W>
constexpr KernelTable<T> MakeTable() {
  return {MakeKind<T, StrandStep<T, W>, HelixWalk<T, W>, W>(),
          MakeKind<T, WoundStep<T, W>, CoilWalk<T, W>, W>()};
}

}  // namespace MANE_ISA
}  // namespace mane::rod
