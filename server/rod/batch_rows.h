#pragma once

/// How kernels read and write the rows of batch_layout.h, one number a lane; only for sources that
/// define MANE_ISA.

#include "rod/batch_layout.h"
#include "rod/batch_vectors.h"
#include "simd/lanes.h"

namespace mane::rod {
namespace MANE_ISA {

/// W lanes of T. All pointers are at the first of their lanes.
template <typename T, int W>
struct Lanewise {
  using V = simd::MANE_ISA::Lanes<T, W>;
  using Vec = Vector<V>;

  static V Row(const T* base, int row) {
    return simd::MANE_ISA::Load<V>(base + row * layout::kLanes);
  }
  static Vec Rows(const T* base, int row) {
    return {Row(base, row), Row(base, row + 1), Row(base, row + 2)};
  }
  static Frame<V> FrameRows(const T* base, int row) {
    return {Rows(base, row), Rows(base, row + 3), Rows(base, row + 6)};
  }
  static void Put(const V& v, T* base, int row) {
    simd::MANE_ISA::Store(v, base + row * layout::kLanes);
  }
  static void Put(const Vec& v, T* base, int row) {
    Put(v.x, base, row), Put(v.y, base, row + 1), Put(v.z, base, row + 2);
  }
  static V All(double x) { return V{} + T(x); }
  /// Asks for `count` rows from `base` on, which may lie beyond the end of all blocks. Memory is
  /// then read while the processor computes: what follows a block is the next one to be stepped.
  [[gnu::always_inline]] static void Expect(const T* base, int count) {
    for (int i = 0; i < count; ++i) __builtin_prefetch(base + i * layout::kLanes, 0, 2);
  }
};

}  // namespace MANE_ISA
}  // namespace mane::rod
