// Laws of strands' colours: each channel has its distribution whatever the wisp share; strands of a
// wisp correlate by it, strands of different wisps and channels do not.

#include "styling/colour.h"

#include <gtest/gtest.h>

#include <cmath>

#include "styling/distribution.h"
#include "styling/kolmogorov.h"

namespace mane::styling {
namespace {

using Form = Distribution::Form;

Roots Wisps(int wisps, int strands_each) {
  Roots roots;
  roots.masters.resize(wisps);
  for (int i = 0; i <= wisps; ++i) roots.first_member.push_back(i * strands_each);
  roots.members.resize(static_cast<size_t>(wisps) * strands_each, Eigen::Vector3f::Zero());
  return roots;
}

Colouring Example(double wisp_share) {
  return {{Form::kUniform, 0, 0, 0.1, 0.3, {}},
          {Form::kNormal, 0.5, 0.2, 0, 1, {}},
          {Form::kSampled, 0, 0, 0.2, 0.9, {0, 3, 1}},
          wisp_share};
}

std::vector<Hsv> ColourOf(const Roots& roots, const Colouring& colouring, int workers = 1) {
  exec::WorkerPool pool(workers);
  return Colour(roots, colouring, 17, pool);
}

TEST(ColourTest, ChannelsHaveTheirDistributionWhateverTheShare) {
  // One strand a wisp, so that draws are independent.
  const Roots roots = Wisps(20000, 1);
  for (double share : {0.0, 0.5, 1.0}) {
    const Colouring colouring = Example(share);
    const auto colours = ColourOf(roots, colouring);
    const Distribution* channels[] = {&colouring.hue, &colouring.saturation, &colouring.value};
    for (int c = 0; c < 3; ++c) {
      std::vector<double> sample;
      for (const Hsv& hsv : colours) sample.push_back(hsv[c]);
      const Quantile quantile(*channels[c]);
      EXPECT_LT(KolmogorovSmirnov(sample, [&](double x) { return quantile.Cdf(x); }),
                kKolmogorovSmirnovLimit);
    }
  }
}

double Correlation(const std::vector<double>& x, const std::vector<double>& y) {
  double mx = 0, my = 0, xx = 0, yy = 0, xy = 0;
  const auto n = static_cast<double>(x.size());
  for (size_t i = 0; i < x.size(); ++i) mx += x[i] / n, my += y[i] / n;
  for (size_t i = 0; i < x.size(); ++i) {
    xx += (x[i] - mx) * (x[i] - mx);
    yy += (y[i] - my) * (y[i] - my);
    xy += (x[i] - mx) * (y[i] - my);
  }
  return xy / std::sqrt(xx * yy);
}

TEST(ColourTest, StrandsOfAWispCorrelateByTheWispShare) {
  const Roots roots = Wisps(20000, 2);
  for (double share : {0.0, 0.3, 0.8, 1.0}) {
    const auto colours = ColourOf(roots, Example(share));
    std::vector<double> first, second, other, hue;
    for (size_t i = 0; i + 3 < colours.size(); i += 2) {
      first.push_back(colours[i][1]);
      second.push_back(colours[i + 1][1]);
      other.push_back(colours[i + 2][1]);
      hue.push_back(colours[i][0]);
    }
    // Standard deviation 1/sqrt(20,000) = 0.007; cutting the normal off at 2.5 deviations and its
    // copula cost the correlation less than 0.01.
    EXPECT_NEAR(Correlation(first, second), share, 0.03);
    EXPECT_NEAR(Correlation(first, other), 0, 0.03);
    EXPECT_NEAR(Correlation(first, hue), 0, 0.03);
    EXPECT_EQ(first == second, share == 1);
  }
}

TEST(ColourTest, HueGoesRound) {
  Colouring colouring = Example(0);
  colouring.hue = {Form::kUniform, 0, 0, -0.1, 0.1, {}};
  int low = 0, high = 0;
  for (const Hsv& hsv : ColourOf(Wisps(100, 10), colouring)) {
    EXPECT_TRUE(hsv[0] >= 0 && hsv[0] < 1);
    low += hsv[0] < 0.1001F;
    high += hsv[0] > 0.8999F;
  }
  EXPECT_EQ(low + high, 1000);
  EXPECT_NEAR(low, 500, 64);  // Four standard deviations.
}

TEST(ColourTest, IsTheSameForAnyNumberOfWorkers) {
  const Roots roots = Wisps(300, 7);
  EXPECT_EQ(ColourOf(roots, Example(0.4), 1), ColourOf(roots, Example(0.4), 4));
}

TEST(ColourTest, RedGreenBlueOfKnownColours) {
  using Rgb = std::array<float, 3>;
  const auto expect = [](const Hsv& hsv, const Rgb& rgb) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(HsvToRgb(hsv)[c], rgb[c], 1e-6F);
  };
  expect({0, 1, 1}, {1, 0, 0});
  expect({1, 1, 1}, {1, 0, 0});
  expect({1 / 12.0F, 1, 1}, {1, 0.5F, 0});
  expect({1 / 6.0F, 1, 1}, {1, 1, 0});
  expect({1 / 3.0F, 1, 1}, {0, 1, 0});
  expect({0.5F, 1, 0.5F}, {0, 0.5F, 0.5F});
  expect({2 / 3.0F, 0.5F, 1}, {0.5F, 0.5F, 1});
  expect({5 / 6.0F, 1, 1}, {1, 0, 1});
  expect({0.123F, 0, 0.7F}, {0.7F, 0.7F, 0.7F});
}

}  // namespace
}  // namespace mane::styling
