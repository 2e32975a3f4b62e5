#pragma once

/// How kernels read and write rows of one number a lane (simd/rows.h); only for sources that define
/// MANE_ISA.

#include "simd/lanes.h"
#include "simd/rows.h"
#include "simd/vectors.h"

namespace mane::simd {
namespace MANE_ISA {

/// W lanes of T. All pointers are at the first of their lanes.
template <typename T, int W>
struct Lanewise {
  using V = Lanes<T, W>;
  using Vec = Vector<V>;

  static V Row(const T* base, int row) { return Load<V>(base + row * kLanes); }
  static Vec Rows(const T* base, int row) {
    return {Row(base, row), Row(base, row + 1), Row(base, row + 2)};
  }
  static Frame<V> FrameRows(const T* base, int row) {
    return {Rows(base, row), Rows(base, row + 3), Rows(base, row + 6)};
  }
  static void Put(const V& v, T* base, int row) { Store(v, base + row * kLanes); }
  static void Put(const Vec& v, T* base, int row) {
    Put(v.x, base, row), Put(v.y, base, row + 1), Put(v.z, base, row + 2);
  }
  static V All(double x) { return V{} + T(x); }
  /// Asks for `count` rows from `base` on, which may lie beyond the end of all blocks. Memory is
  /// then read while the processor computes: what follows a block is the next one to be stepped.
  [[gnu::always_inline]] static void Expect(const T* base, int count) {
    for (int i = 0; i < count; ++i) __builtin_prefetch(base + i * kLanes, 0, 2);
  }
};

}  // namespace MANE_ISA
}  // namespace mane::simd
