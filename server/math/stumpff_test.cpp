// Properties of the Stumpff functions, in long double where an oracle computes:
//   series       agree with their defining power series where that loses no digits
//   closed form  agree with sines and cosines beyond
//   recurrence   c_n = 1/n! - z c_{n+2}
//   derivative   2 dc_n/dz agrees with finite differences of the oracle
//   switch       the two evaluations meet
//   tail         c7 and c8 agree with the oracle, 4 d^2c_n/dz^2 with its second differences

#include "math/stumpff.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mane::math {
namespace {

constexpr double kEps = std::numeric_limits<double>::epsilon();

long double Factorial(int n) { return n < 2 ? 1 : n * Factorial(n - 1); }

// The definition. For z <= 30 the largest term is below e^sqrt(30) = 240, so that cancellation
// costs at most 240 long double ulp, 3e-17.
long double DefiningSeries(int n, long double z) {
  long double sum = 0, term = 1 / Factorial(n);
  for (int k = 0; k < 60; ++k) {
    sum += term;
    term *= -z / ((n + 2 * k + 1) * (n + 2 * k + 2));
  }
  return sum;
}

// Sines and cosines with their Taylor polynomials taken off.
long double ClosedForm(int n, long double z) {
  const long double x = std::sqrt(z), s = std::sin(x), c = std::cos(x);
  switch (n) {
    case 0:
      return c;
    case 1:
      return s / x;
    case 2:
      return 2 * std::sin(x / 2) * std::sin(x / 2) / z;
    case 3:
      return (x - s) / (z * x);
    case 4:
      return (c - 1 + z / 2) / (z * z);
    case 5:
      return (s - x + z * x / 6) / (z * z * x);
    default:
      return (1 - z / 2 + z * z / 24 - c) / (z * z * z);
  }
}

long double Oracle(int n, long double z) {
  return z <= 30 ? DefiningSeries(n, z) : ClosedForm(n, z);
}

// c_n is at most 1/n! and oscillates through zero for n <= 2, so errors are measured in ulp of
// 1/n!. Beyond the switch the rounding of x = sqrt(z) moves the phase by x ulp, and c_{n+2} = (1/n!
// - c_n)/z multiplies ulp of 1/n! by (n + 1)(n + 2) / z: at z = 4 by 3 from c2 to c4 and by 7.5
// more to c6.
double Tolerance(int n, double z) {
  const double growth = n >= 5 ? 22.5 : n >= 3 ? 3 : 1;
  return (4 + growth + std::sqrt(z)) * kEps / static_cast<double>(Factorial(n));
}

TEST(StumpffTest, OraclesAgreeWhereBothHold) {
  for (long double z = 4; z <= 30; z += 0.37L) {
    for (int n = 0; n < 7; ++n) {
      EXPECT_NEAR(static_cast<double>((DefiningSeries(n, z) - ClosedForm(n, z)) * Factorial(n)), 0,
                  1e-15)
          << "n=" << n << " z=" << static_cast<double>(z);
    }
  }
}

TEST(StumpffTest, AgreesWithSeriesAndTrigonometry) {
  for (double x = 0; x < 120; x += 0.0173) {
    const double z = x * x;
    const Stumpff c = StumpffC(z);
    for (int n = 0; n < 7; ++n) {
      EXPECT_NEAR(c[n], static_cast<double>(Oracle(n, z)), Tolerance(n, z))
          << "n=" << n << " z=" << z;
    }
  }
}

TEST(StumpffTest, TinyArgumentsGiveTheInverseFactorials) {
  for (const double z : {0.0, 1e-300, 1e-100, 1e-30, 1e-18}) {
    const Stumpff c = StumpffC(z);
    for (int n = 0; n < 7; ++n) {
      EXPECT_DOUBLE_EQ(c[n], static_cast<double>(1 / Factorial(n))) << "n=" << n << " z=" << z;
    }
  }
}

TEST(StumpffTest, SatisfiesTheRecurrence) {
  for (double z = 0; z < 3000; z = 1.07 * z + 0.01) {
    const Stumpff c = StumpffC(z);
    for (int n = 0; n <= 4; ++n) {
      const double inverse_factorial = static_cast<double>(1 / Factorial(n));
      EXPECT_NEAR(c[n] + z * c[n + 2], inverse_factorial, 4 * kEps * inverse_factorial)
          << "n=" << n << " z=" << z;
    }
  }
}

TEST(StumpffTest, DerivativeAgreesWithFiniteDifferences) {
  for (double z = 0.01; z < 3000; z = 1.11 * z + 0.01) {
    const Stumpff c = StumpffC(z);
    // Fourth order central differences. In x = sqrt(z) the functions vary on the scale 1, so the
    // step h = 1e-3 max(1, x) errs by 1e-12 / 30 and rounds by 1e-19 / 1e-3, against 1/n!.
    const long double h = std::min<long double>(1e-3L * std::max(1.0, std::sqrt(z)), z / 4);
    for (int n = 0; n <= 4; ++n) {
      const auto f = [&](int i) { return Oracle(n, static_cast<long double>(z) + i * h); };
      const long double slope = (8 * (f(1) - f(-1)) - (f(2) - f(-2))) / (12 * h);
      EXPECT_NEAR(TwiceDerivative(c, n), static_cast<double>(2 * slope),
                  1e-11 / static_cast<double>(Factorial(n)))
          << "n=" << n << " z=" << z;
    }
  }
}

TEST(StumpffTest, EvaluationsMeetAtTheSwitch) {
  const double switch_at = 4;
  const Stumpff below = StumpffC(switch_at), above = StumpffC(std::nextafter(switch_at, 5.0));
  for (int n = 0; n < 7; ++n) {
    EXPECT_NEAR(below[n], above[n], 2 * Tolerance(n, switch_at)) << "n=" << n;
  }
}

TEST(StumpffTest, TailAgreesWithTheOracle) {
  for (double z = 0; z < 3000; z = 1.07 * z + 0.01) {
    const StumpffTail tail = StumpffCTail(StumpffC(z), z);
    // Beyond the switch c_n inherits the error of c_{n-2} times n (n - 1) / z.
    const auto oracle = [&](int n) {
      const long double inverse_factorial = 1 / Factorial(n - 2);
      return z <= 30 ? DefiningSeries(n, z) : (inverse_factorial - Oracle(n - 2, z)) / z;
    };
    EXPECT_NEAR(tail.c7 * 5040, static_cast<double>(oracle(7) * 5040), 1e-13) << "z=" << z;
    EXPECT_NEAR(tail.c8 * 40320, static_cast<double>(oracle(8) * 40320), 1e-13) << "z=" << z;
  }
}

TEST(StumpffTest, SecondDerivativeAgreesWithFiniteDifferences) {
  for (double z = 0.01; z < 3000; z = 1.11 * z + 0.01) {
    const Stumpff c = StumpffC(z);
    const StumpffTail tail = StumpffCTail(c, z);
    // Fourth order second differences of functions that vary on the scale 1 of x = sqrt(z): h =
    // 1e-2 max(1, x) errs by 1e-8 / 90 and rounds by 1e-19 / 1e-4, against 1/n!.
    const long double h = std::min<long double>(1e-2L * std::max(1.0, std::sqrt(z)), z / 4);
    for (int n = 0; n <= 4; ++n) {
      const auto f = [&](int i) { return Oracle(n, static_cast<long double>(z) + i * h); };
      const long double second = (16 * (f(1) + f(-1)) - (f(2) + f(-2)) - 30 * f(0)) / (12 * h * h);
      EXPECT_NEAR(FourTimesSecondDerivative(c, tail, n), static_cast<double>(4 * second),
                  1e-8 / static_cast<double>(Factorial(n)))
          << "n=" << n << " z=" << z;
    }
  }
}

}  // namespace
}  // namespace mane::math
