#pragma once

#if defined(__AVX2__)
#include <immintrin.h>
#elif defined(__aarch64__)
#include <arm_neon.h>
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

/// Square roots of all lanes.
[[gnu::always_inline]] inline float Sqrt(float x) { return __builtin_sqrtf(x); }
[[gnu::always_inline]] inline double Sqrt(double x) { return __builtin_sqrt(x); }
#if defined(__AVX2__)
[[gnu::always_inline]] inline Lanes<float, 8> Sqrt(Lanes<float, 8> x) { return _mm256_sqrt_ps(x); }
[[gnu::always_inline]] inline Lanes<double, 4> Sqrt(Lanes<double, 4> x) {
  return _mm256_sqrt_pd(x);
}
#endif
#if defined(__AVX512F__)  // The unmasked ones of GCC 12 warn of themselves.
[[gnu::always_inline]] inline Lanes<float, 16> Sqrt(Lanes<float, 16> x) {
  return _mm512_maskz_sqrt_ps(0xffff, x);
}
[[gnu::always_inline]] inline Lanes<double, 8> Sqrt(Lanes<double, 8> x) {
  return _mm512_maskz_sqrt_pd(0xff, x);
}
#endif
#if defined(__aarch64__)
[[gnu::always_inline]] inline Lanes<float, 4> Sqrt(Lanes<float, 4> x) { return vsqrtq_f32(x); }
[[gnu::always_inline]] inline Lanes<double, 2> Sqrt(Lanes<double, 2> x) { return vsqrtq_f64(x); }
#endif

/// Whether any lane of a comparison holds.
template <typename M>
[[gnu::always_inline]] inline bool Any(const M& mask) {
#if defined(__AVX512DQ__)
  if constexpr (sizeof(M) == 64) return _mm512_movepi32_mask(__builtin_bit_cast(__m512i, mask));
#endif
#if defined(__AVX2__)
  if constexpr (sizeof(M) == 32) return _mm256_movemask_epi8(__builtin_bit_cast(__m256i, mask));
#endif
  if constexpr (sizeof(M) <= sizeof(int)) {  // One lane: a bool, or several joined by & and |.
    return mask != 0;
  } else {
    long long words[sizeof(M) / sizeof(long long)], any = 0;
    __builtin_memcpy(words, &mask, sizeof(M));
    for (const long long word : words) any |= word;
    return any != 0;
  }
}

}  // namespace MANE_ISA
}  // namespace mane::simd
