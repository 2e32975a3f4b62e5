#pragma once

#include "beam/motion_layout.h"

namespace mane::beam {

/// Dynamics of a block (beam.md, B7 to B15). Constants, states and winds begin at the block's first
/// row (motion_layout.h).
template <typename T>
struct MotionKernels {
  /// Advances a block. `wind` [m/s] (3), world.
  void (*step)(const layout::MotionShape<T>& shape, const layout::MotionStep<T>& step,
               const T* constants, const T* wind, T* state);
  /// Nodes, ((segments + 1) x 3) rows, from the head's place in world axes [m].
  void (*nodes)(const layout::MotionShape<T>& shape, const layout::MotionPlace<T>& place,
                const T* constants, const T* state, T* nodes);
};

}  // namespace mane::beam
