// Properties of the counter-based streams, with fixed seeds so that every run sees the same
// numbers:
//   counter       the k-th number depends on seed, stream and k alone
//   distinct      neighbouring seeds and streams share no numbers
//   uniform       chi-square along a stream and across streams; neighbours uncorrelated
//   normal        mean, variance, skewness, kurtosis, tails

#include "math/random.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>
#include <vector>

namespace mane::math {
namespace {

TEST(RandomStreamTest, NumbersDependOnSeedStreamAndCountAlone) {
  std::vector<uint64_t> alone;
  RandomStream stream(42, 7);
  for (int k = 0; k < 100; ++k) alone.push_back(stream.Bits());
  RandomStream again(42, 7), other(42, 8), seed(43, 7);
  for (int k = 0; k < 100; ++k) {
    (void)other.Bits();
    if (k % 3 == 0) (void)seed.Normal();
    EXPECT_EQ(again.Bits(), alone[k]) << k;
  }
}

TEST(RandomStreamTest, SeedsAndStreamsShareNoNumbers) {
  std::set<uint64_t> seen;
  for (uint64_t seed = 0; seed < 30; ++seed) {
    for (uint64_t stream = 0; stream < 30; ++stream) {
      RandomStream random(seed, stream);
      for (int k = 0; k < 20; ++k) seen.insert(random.Bits());
    }
  }
  EXPECT_EQ(seen.size(), 30u * 30u * 20u);  // By chance alone: 1e-11 pairs.
}

// Chi-square of `counts` against equal shares, as standard deviations from its mean.
double ChiSquareDeviation(const std::vector<int>& counts) {
  double total = 0, chi2 = 0;
  for (const int count : counts) total += count;
  const double expected = total / counts.size(), freedom = counts.size() - 1.0;
  for (const int count : counts) chi2 += (count - expected) * (count - expected) / expected;
  return (chi2 - freedom) / std::sqrt(2 * freedom);
}

TEST(RandomStreamTest, UniformAlongAStream) {
  RandomStream random(1, 2);
  std::vector<int> high(256), low(256), joint(1024);
  double previous = 0.5;
  for (int k = 0; k < 400000; ++k) {
    const double u = random.Uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    ++high[static_cast<int>(u * 256)];
    ++low[static_cast<int64_t>(u * 0x1p53) & 255];
    ++joint[32 * static_cast<int>(32 * previous) + static_cast<int>(32 * u)];
    previous = u;
  }
  EXPECT_LT(std::abs(ChiSquareDeviation(high)), 4);
  EXPECT_LT(std::abs(ChiSquareDeviation(low)), 4);
  EXPECT_LT(std::abs(ChiSquareDeviation(joint)), 4);
}

TEST(RandomStreamTest, UniformAcrossStreamsAndSeeds) {
  std::vector<int> streams(256), seeds(256);
  double sum = 0;
  const int n = 200000;
  for (int i = 0; i < n; ++i) {
    const double a = RandomStream(5, i).Uniform(), b = RandomStream(5, i + 1).Uniform();
    ++streams[static_cast<int>(256 * a)];
    ++seeds[static_cast<int>(256 * RandomStream(i, 5).Uniform())];
    sum += (a - 0.5) * (b - 0.5);
  }
  EXPECT_LT(std::abs(ChiSquareDeviation(streams)), 4);
  EXPECT_LT(std::abs(ChiSquareDeviation(seeds)), 4);
  // Covariance of independent uniforms: mean 0, standard deviation 1/12 / sqrt(n).
  EXPECT_LT(std::abs(sum / n), 4.0 / 12 / std::sqrt(n));
}

TEST(RandomStreamTest, UniformFillsTheIntervalAskedFor) {
  RandomStream random(3, 4);
  double low = 1e9, high = -1e9, sum = 0;
  const int n = 100000;
  for (int k = 0; k < n; ++k) {
    const double u = random.Uniform(-3, 5);
    low = std::min(low, u);
    high = std::max(high, u);
    sum += u;
  }
  EXPECT_GE(low, -3);
  EXPECT_LT(high, 5);
  // n draws leave a gap above 8 * 14 / n at an end with probability e^-14.
  EXPECT_LT(low, -3 + 8 * 14.0 / n);
  EXPECT_GT(high, 5 - 8 * 14.0 / n);
  EXPECT_NEAR(sum / n, 1, 4 * 8 / std::sqrt(12.0 * n));
}

TEST(RandomStreamTest, NormalHasTheMomentsAndTailsOfANormal) {
  RandomStream random(9, 1);
  const int n = 400000;
  double m1 = 0, m2 = 0, m3 = 0, m4 = 0;
  int beyond_two = 0;
  for (int k = 0; k < n; ++k) {
    const double x = random.Normal();
    ASSERT_TRUE(std::isfinite(x));
    m1 += x;
    m2 += x * x;
    m3 += x * x * x;
    m4 += x * x * x * x;
    beyond_two += std::abs(x) > 2;
  }
  // Standard deviations of the sample moments: sqrt(1, 2, 15, 96) / sqrt(n).
  const double root = std::sqrt(n);
  EXPECT_LT(std::abs(m1 / n), 4 / root);
  EXPECT_LT(std::abs(m2 / n - 1), 4 * std::sqrt(2) / root);
  EXPECT_LT(std::abs(m3 / n), 4 * std::sqrt(15) / root);
  EXPECT_LT(std::abs(m4 / n - 3), 4 * std::sqrt(96) / root);
  const double share = 0.0455002639;  // P(|x| > 2)
  EXPECT_LT(std::abs(static_cast<double>(beyond_two) / n - share),
            4 * std::sqrt(share * (1 - share)) / root);
}

}  // namespace
}  // namespace mane::math
