// Sines, cosines and wrapped angles of lanes against those of the library, over a few turns.

#define MANE_ISA angles_test

#include "simd/angles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mane::simd {
namespace {

template <typename T>
class AnglesTest : public testing::Test {};
using Numbers = testing::Types<float, double>;
TYPED_TEST_SUITE(AnglesTest, Numbers);

TYPED_TEST(AnglesTest, AreThoseOfTheLibrary) {
  using T = TypeParam;
  using V = angles_test::Lanes<T, 16 / sizeof(T)>;
  constexpr T kUlp = std::numeric_limits<T>::epsilon();
  for (int i = -4000; i <= 4000; ++i) {
    const T x = static_cast<T>(i) * T(0.005);
    V s, c;
    angles_test::SinCos<T>(V{} + x, s, c);
    T one_s, one_c;
    angles_test::SinCos<T>(x, one_s, one_c);
    for (const T sine : {s[0], one_s}) EXPECT_NEAR(sine, std::sin(x), kUlp) << x;
    for (const T cosine : {c[1], one_c}) EXPECT_NEAR(cosine, std::cos(x), kUlp) << x;
  }
}

TYPED_TEST(AnglesTest, AreThoseOfTheLibraryAtQuarters) {
  using T = TypeParam;
  constexpr T kUlp = std::numeric_limits<T>::epsilon();
  for (int i = -40; i <= 40; ++i) {
    const T x = static_cast<T>(i * std::numbers::pi / 8);
    T s, c;
    angles_test::SinCos<T>(x, s, c);
    EXPECT_NEAR(s, std::sin(x), kUlp) << i;
    EXPECT_NEAR(c, std::cos(x), kUlp) << i;
  }
}

TYPED_TEST(AnglesTest, WrapWithinHalfATurn) {
  using T = TypeParam;
  constexpr double kUlp = std::numeric_limits<T>::epsilon();
  for (int i = -4000; i <= 4000; ++i) {
    const T x = static_cast<T>(i) * T(0.005);
    const double wrapped = angles_test::Wrapped<T>(x);
    EXPECT_LE(std::abs(wrapped), std::numbers::pi * (1 + 4 * kUlp));
    EXPECT_NEAR(std::remainder(wrapped - x, 2 * std::numbers::pi), 0, 20 * kUlp) << x;
  }
}

}  // namespace
}  // namespace mane::simd
