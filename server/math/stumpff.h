#pragma once

#include <array>

namespace mane::math {

/// Stumpff functions c_n(z) = sum_k (-z)^k / (n + 2k)!, n = 0..6: entire functions that hold what a
/// helix needs without a case for zero angle. With z = x^2: c0 = cos x, c1 = sin x / x,
/// c2 = (1 - cos x) / x^2, and c_n = 1/n! - z c_{n+2}.
using Stumpff = std::array<double, 7>;

/// All c_n at `z` >= 0, each to 20 ulp. No allocation.
[[nodiscard]] Stumpff StumpffC(double z);

/// Twice the derivative, 2 dc_n/dz = n c_{n+2} - c_{n+1}, for n <= 4.
[[nodiscard]] inline double TwiceDerivative(const Stumpff& c, int n) {
  return n * c[n + 2] - c[n + 1];
}

/// c_7 and c_8 at `z` >= 0, which second derivatives need; `c` is StumpffC(z). To 1e-13 of each.
struct StumpffTail {
  double c7;
  double c8;
};
[[nodiscard]] StumpffTail StumpffCTail(const Stumpff& c, double z);

/// Four times the second derivative, 4 d^2c_n/dz^2 = n (n + 2) c_{n+4} - (2n + 1) c_{n+3} +
/// c_{n+2}, for n <= 4.
[[nodiscard]] inline double FourTimesSecondDerivative(const Stumpff& c, const StumpffTail& tail,
                                                      int n) {
  const auto at = [&](int m) { return m == 8 ? tail.c8 : m == 7 ? tail.c7 : c[m]; };
  return n * (n + 2) * at(n + 4) - (2 * n + 1) * at(n + 3) + at(n + 2);
}

}  // namespace mane::math
