#include "math/stumpff.h"

#include <cmath>

namespace mane::math {
namespace {

// Up to here the series loses no digits to cancellation, from here on the recurrence does not.
constexpr double kSeriesLimit = 4;
// 4^12 / 30! < 1e-25 of the first term.
constexpr int kTerms = 13;

// sum_k (-z)^k / (n + 2k)! by Horner, from the last term.
double Series(int n, double z) {
  double sum = 1;
  for (int k = kTerms - 1; k > 0; --k) {
    sum = 1 - z * sum / ((n + 2 * k - 1) * (n + 2 * k));
  }
  double factorial = 1;
  for (int i = 2; i <= n; ++i) factorial *= i;
  return sum / factorial;
}

}  // namespace

Stumpff StumpffC(double z) {
  Stumpff c;
  if (z <= kSeriesLimit) {
    c[6] = Series(6, z);
    c[5] = Series(5, z);
    c[4] = 1.0 / 24 - z * c[6];
    c[3] = 1.0 / 6 - z * c[5];
    c[2] = 0.5 - z * c[4];
    c[1] = 1 - z * c[3];
    c[0] = 1 - z * c[2];
    return c;
  }
  const double x = std::sqrt(z);
  c[0] = std::cos(x);
  c[1] = std::sin(x) / x;
  c[2] = (1 - c[0]) / z;
  c[3] = (1 - c[1]) / z;
  c[4] = (0.5 - c[2]) / z;
  c[5] = (1.0 / 6 - c[3]) / z;
  c[6] = (1.0 / 24 - c[4]) / z;
  return c;
}

StumpffTail StumpffCTail(const Stumpff& c, double z) {
  if (z > kSeriesLimit) return {(1.0 / 120 - c[5]) / z, (1.0 / 720 - c[6]) / z};
  // Horner from the tenth term, which is 4^9 7! / 25! < 1e-16 of the first.
  constexpr int kTailTerms = 10;
  double c7 = 1, c8 = 1;
  for (int k = kTailTerms - 1; k > 0; --k) {
    c7 = 1 - z * c7 * (1.0 / ((6 + 2 * k) * (7 + 2 * k)));
    c8 = 1 - z * c8 * (1.0 / ((7 + 2 * k) * (8 + 2 * k)));
  }
  return {c7 / 5040, c8 / 40320};
}

}  // namespace mane::math
