#pragma once

#if defined(__AVX2__)
#include <immintrin.h>
#endif

/// Vectors of W numbers, one per lane. Only for sources that are compiled once for each instruction
/// set: MANE_ISA names it, and with it the namespace, so that no two of them share a function.
///
/// GCC's vector extensions rather than intrinsics or a library: `+ - * /`, comparisons and `?:`
/// work on lanes, one template serves float and double on every width, and a plain number is a
/// lane.

namespace mane::simd {
namespace MANE_ISA {

template <typename T, int W>
struct LanesOf {
  typedef T Type __attribute__((vector_size(W * sizeof(T))));
};
template <typename T>
struct LanesOf<T, 1> {
  using Type = T;
};

/// W numbers; W = 1 is the number itself.
template <typename T, int W>
using Lanes = typename LanesOf<T, W>::Type;

/// Reads W numbers from `source`, aligned to their size.
template <typename V, typename T>
[[gnu::always_inline]] inline V Load(const T* source) {
  V v;
  __builtin_memcpy(&v, __builtin_assume_aligned(source, sizeof(V)), sizeof(V));
  return v;
}

template <typename V, typename T>
[[gnu::always_inline]] inline void Store(const V& v, T* target) {
  __builtin_memcpy(__builtin_assume_aligned(target, sizeof(V)), &v, sizeof(V));
}

/// Whether any lane of a comparison holds.
template <typename M>
[[gnu::always_inline]] inline bool Any(const M& mask) {
#if defined(__AVX512DQ__)
  if constexpr (sizeof(M) == 64) return _mm512_movepi32_mask(__builtin_bit_cast(__m512i, mask));
#endif
#if defined(__AVX2__)
  if constexpr (sizeof(M) == 32) return _mm256_movemask_epi8(__builtin_bit_cast(__m256i, mask));
#endif
  if constexpr (sizeof(M) == sizeof(bool)) {
    return mask;
  } else {
    long long words[sizeof(M) / sizeof(long long)], any = 0;
    __builtin_memcpy(words, &mask, sizeof(M));
    for (const long long word : words) any |= word;
    return any != 0;
  }
}

}  // namespace MANE_ISA
}  // namespace mane::simd
