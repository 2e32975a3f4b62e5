#pragma once

/// How blocks of strands lie in memory for batched kernels: rows of kLanes numbers, one lane a
/// strand, the same for every instruction set.
namespace mane::simd {

/// Strands in a block; every kernel's width divides it.
inline constexpr int kLanes = 16;

/// Blocks that so many strands fill, the last in part.
constexpr int BlocksOf(int strands) { return (strands + kLanes - 1) / kLanes; }

/// One number of each strand of a block, aligned for every kernel.
template <typename T>
struct alignas(64) Row {
  T lane[kLanes];
};

}  // namespace mane::simd
