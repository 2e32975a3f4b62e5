#pragma once

/// Sines, cosines and wrapped angles of lanes; only for sources that define MANE_ISA.

#include "simd/lanes.h"

namespace mane::simd {
namespace MANE_ISA {

/// The nearest whole number of x, |x| below 2^22 (float) or 2^51 (double).
template <typename T, typename V>
[[gnu::always_inline]] inline V Nearest(const V& x) {
  constexpr T kShift = sizeof(T) == 4 ? T(0x1.8p23) : T(0x1.8p52);
  return (x + kShift) - kShift;
}

/// x [rad] less whole turns, within [-pi, pi] up to rounding.
template <typename T, typename V>
[[gnu::always_inline]] inline V Wrapped(const V& x) {
  return x - T(6.283185307179586477) * Nearest<T>(T(0.15915494309189533577) * x);
}

/// Sine and cosine of x [rad], |x| at most a few turns, to two units in the last place of 1:
/// Taylor's series within an eighth of a turn about the nearest quarter.
template <typename T, typename V>
[[gnu::always_inline]] inline void SinCos(const V& x, V& sine, V& cosine) {
  const V quarter = Nearest<T>(T(0.63661977236758134308) * x);
  // pi / 2 in two parts, of which the first times a small whole number is exact.
  constexpr T kHigh = sizeof(T) == 4 ? T(1.5703125) : T(0x1.921fb544p0);
  constexpr T kLow = T(1.570796326794896619231L - static_cast<long double>(kHigh));
  const V r = (x - kHigh * quarter) - kLow * quarter, q = r * r;
  V s = V{} + 1, c = V{} + 1;
  constexpr int kTerms = sizeof(T) == 4 ? 5 : 8;
#pragma GCC unroll 8
  for (int n = kTerms; n > 0; --n) {
    s = T(1) - q * s * T(1.0 / (2 * n * (2 * n + 1)));
    c = T(1) - q * c * T(1.0 / (2 * n * (2 * n - 1)));
  }
  s = r * s;
  const V half = T(0.5) * quarter, quarters = quarter - T(4) * Nearest<T>(T(0.25) * quarter);
  const auto odd = (half - Nearest<T>(half)) != T(0);
  // Quarters are now -2 to 2: -2 and 2 alike negate both, -1 and 1 exchange them.
  const auto opposite = (quarters > T(1.5)) | (quarters < T(-1.5));
  const V turned_sine = quarters > T(0) ? c : -c, turned_cosine = quarters > T(0) ? -s : s;
  sine = odd ? turned_sine : (opposite ? -s : s);
  cosine = odd ? turned_cosine : (opposite ? -c : c);
}

}  // namespace MANE_ISA
}  // namespace mane::simd
