#pragma once

#include <cstddef>
#include <span>

#include "rod/batch_layout.h"
#include "simd/isa.h"

namespace mane::rod {

/// The batched kernels of one kind of strand, for numbers of type T (float or double). Blocks are
/// those of batch_layout.h, aligned to 64 bytes. Pure functions of their arguments: each lane's
/// result depends on nothing in other lanes.
template <typename T>
struct KindKernels {
  /// Advances a block of kLanes strands of `N` elements by one step (rod.md, S1 to S11).
  ///
  /// @param drive    (kDriveRows x kLanes)
  /// @param scratch  N times scratch_per_element bytes, aligned to 64.
  /// @param size     out: square of the largest angles or unknowns of an element of each strand
  ///                 [rad^2]; 1e30 where the strand's new state is not finite.
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

  /// A step in two parts, with loads on points of the strands (S13, S14): at the fractions k / n of
  /// each element, k = 1 .. n; of wound strands, points of the axis.
  ///
  /// @param first_point  of each element, and how many there are in all (N + 1): element Q has n =
  ///                     first_point[Q + 1] - first_point[Q] >= 1.
  /// @param scratch      approach_scratch(N, points) bytes, aligned to 64; as approach left it, for
  ///                     any number of solves.
  /// @param points       out: (points x kPointRows x kLanes)
  void (*approach)(int N, const int* first_point, const T* constants, const T* drive,
                   const T* state, void* scratch, T* points);
  /// @param loads       (points x kLoadRows x kLanes)
  /// @param loaded      whether any lane of a point has a load; others are not read, (points).
  /// @param watched     whose velocities are wanted, (points).
  /// @param next        out: the state that `state` goes to.
  /// @param velocities  out: of the points in the step, world [m/s], (points x 3 x kLanes)
  /// @param size        as of step.
  /// @param turning     out: largest acceleration by which joints of each strand leave the straight
  ///                    lines that the step takes them along (S16) [m/s^2].
  void (*solve)(int N, const int* first_point, const T* constants, const T* drive, const T* state,
                const T* loads, const unsigned char* loaded, const unsigned char* watched,
                void* scratch, T* next, T* velocities, T* size, T* turning);
  size_t (*approach_scratch)(int N, int points);
};

/// The batched kernels of one instruction set.
template <typename T>
struct KernelTable {
  KindKernels<T> plain;  ///< Super-Helices.
  KindKernels<T> wound;  ///< Super-Helices along the axis of a coil (coil.md).

  [[nodiscard]] const KindKernels<T>& Of(layout::Kind kind) const {
    return kind == layout::Kind::kWound ? wound : plain;
  }
};

/// Kernels for an instruction set that simd::Supported() lists.
template <typename T>
[[nodiscard]] const KernelTable<T>& KernelsFor(simd::Isa isa);

}  // namespace mane::rod
