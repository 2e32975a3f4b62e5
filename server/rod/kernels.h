#pragma once

#include <span>

#include "rod/batch_layout.h"
#include "simd/isa.h"

namespace mane::rod {

/// The batched kernels of one instruction set, for numbers of type T (float or double). Blocks are
/// those of batch_layout.h, aligned to 64 bytes. Pure functions of their arguments: each lane's
/// result depends on nothing in other lanes.
template <typename T>
struct KernelTable {
  /// Advances a block of kLanes strands of `N` elements by one step (rod.md, S1 to S7).
  ///
  /// @param drive    (kDriveRows x kLanes)
  /// @param scratch  ScratchSize(N) bytes, aligned to 64.
  /// @param size     out: largest |theta|^2 of an element of each strand [rad^2]; 1e30 where
  ///                 the strand's new state is not finite.
  void (*step)(int N, const T* constants, const T* drive, T* state, void* scratch, T* size);

  /// Points at equal arc length, root and tip included.
  ///
  /// @param pose       (kPoseRows x kLanes)
  /// @param points     >= 2
  /// @param positions  out: (points x 3 x kLanes) [m], in the frame that `pose` leads to.
  void (*sample)(int N, const T* constants, const T* pose, const T* state, int points,
                 T* positions);

  /// Bytes of scratch that `step` needs per element.
  int scratch_per_element;
};

/// Kernels for an instruction set that simd::Supported() lists.
template <typename T>
[[nodiscard]] const KernelTable<T>& KernelsFor(simd::Isa isa);

}  // namespace mane::rod
