#pragma once

namespace mane::beam {

/// Dynamics of a block (beam.md, B7 to B15).
template <typename T>
struct MotionKernels {};

}  // namespace mane::beam
