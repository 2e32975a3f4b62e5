#pragma once

namespace mane::beam {

/// Statics of a block (beam.md, B3 to B6).
template <typename T>
struct BendKernels {};

}  // namespace mane::beam
