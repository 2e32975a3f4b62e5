#include "styling/distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/random.h"
#include "styling/kolmogorov.h"

namespace mane::styling {
namespace {

using Form = Distribution::Form;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Distribution> Examples() {
  return {{Form::kUniform, 0, 0, 0.2, 1.4, {}},
          {Form::kNormal, 0.8, 0.2, 0.1, 1.5, {}},
          {Form::kNormal, 0.3, 0.5, 0.3, 0.4, {}},
          {Form::kNormal, 0.9, 1e-3, 0, 2, {}},
          {Form::kSampled, 0, 0, 0.5, 1.5, {0, 1, 0}},
          {Form::kSampled, 0, 0, 0.5, 1.5, {3, 0, 0, 0, 2, 1e-9, 5}}};
}

TEST(DistributionTest, QuantileInvertsTheNormalDistribution) {
  for (double x = -12; x <= 5; x += 0.01) {
    // The quantile's condition: an error of 2^-52 of u (above 1/2, of 1 - u) over the density.
    const double u = NormalCdf(x), density = std::exp(-0.5 * x * x) / 2.5066;
    const double tolerance = 1e-13 * (1 + std::abs(x)) + 4e-16 * (x > 0 ? 1 : u) / density;
    EXPECT_NEAR(NormalQuantile(u), x, tolerance);
  }
  EXPECT_EQ(NormalQuantile(0.5), 0);
  EXPECT_EQ(NormalQuantile(0), -NormalQuantile(1));
}

TEST(DistributionTest, QuantileInvertsTheDistributionFunction) {
  for (const Distribution& example : Examples()) {
    ASSERT_TRUE(Validate(example, "d", 0, 2).has_value());
    const Quantile quantile(example);
    double last = quantile.low();
    for (int i = 0; i <= 1000; ++i) {
      const double u = i / 1000.0, x = quantile(u);
      EXPECT_NEAR(quantile.Cdf(x), u, 1e-9);
      EXPECT_GE(x, last);
      EXPECT_LE(x, quantile.high());
      last = x;
    }
    EXPECT_EQ(quantile.Cdf(quantile.low() - 0.1), 0);
    EXPECT_EQ(quantile.Cdf(quantile.high()), 1);
  }
}

TEST(DistributionTest, DrawsFollowTheDistributionAndItsMean) {
  for (const Distribution& example : Examples()) {
    const Quantile quantile(example);
    math::RandomStream random(5, 0);
    std::vector<double> draws(50000);
    double mean = 0;
    for (double& x : draws) mean += (x = quantile(random.Uniform())) / 50000;
    EXPECT_LT(KolmogorovSmirnov(draws, [&](double x) { return quantile.Cdf(x); }),
              kKolmogorovSmirnovLimit);
    // Four standard deviations of a mean; that of a draw is at most half the support.
    EXPECT_NEAR(mean, quantile.Mean(), 4 * 0.5 * (quantile.high() - quantile.low()) / 223);
  }
}

TEST(DistributionTest, SampledDensitiesAreWhatTheFunctionRisesBy) {
  const Distribution triangle{Form::kSampled, 0, 0, 1, 3, {0, 7, 0}};
  const Quantile quantile(triangle);
  for (double x = 1; x <= 3; x += 0.05) {
    const double closed = x <= 2 ? 0.5 * (x - 1) * (x - 1) : 1 - 0.5 * (3 - x) * (3 - x);
    EXPECT_NEAR(quantile.Cdf(x), closed, 1e-12);
  }
  EXPECT_NEAR(quantile.Mean(), 2, 1e-12);
}

TEST(DistributionTest, WithoutWidthItIsAConstant) {
  EXPECT_EQ(Quantile({Form::kConstant, 0.7, 0, 0, 2, {}})(0.3), 0.7);
  EXPECT_EQ(Quantile({Form::kNormal, 0.7, 0, 0, 2, {}})(0.3), 0.7);
  EXPECT_EQ(Quantile({Form::kUniform, 0, 0, 0.6, 0.6, {}})(0.3), 0.6);
  EXPECT_EQ(Quantile({Form::kSampled, 0, 0, 0.6, 0.6, {1, 2}}).Mean(), 0.6);
  EXPECT_EQ(Quantile({Form::kConstant, 0.7, 0, 0, 2, {}}).high(), 0.7);
}

TEST(DistributionTest, FaultsAreNamed) {
  const auto field = [](const Distribution& d) {
    const auto valid = Validate(d, "l", 0, 2);
    return valid ? "" : valid.error().field;
  };
  EXPECT_EQ(field({Form::kConstant, 2.1, 0, 0, 2, {}}), "l.constant.value");
  EXPECT_EQ(field({Form::kConstant, kNan, 0, 0, 2, {}}), "l.constant.value");
  EXPECT_EQ(field({Form::kConstant, 1, kNan, 5, 2, {}}), "");  // Not of its form.
  EXPECT_EQ(field({Form::kUniform, 0, 0, -0.1, 2, {}}), "l.uniform.low");
  EXPECT_EQ(field({Form::kUniform, 0, 0, 1, 0.9, {}}), "l.uniform.high");
  EXPECT_EQ(field({Form::kUniform, 0, 0, 1, kNan, {}}), "l.uniform.high");
  EXPECT_EQ(field({Form::kNormal, 0.5, 1, 1, 2, {}}), "l.normal.mean");
  EXPECT_EQ(field({Form::kNormal, 1.5, -1, 1, 2, {}}), "l.normal.deviation");
  EXPECT_EQ(field({Form::kSampled, 0, 0, 1, 2, {1}}), "l.sampled.densities");
  EXPECT_EQ(field({Form::kSampled, 0, 0, 1, 2, {0, 0}}), "l.sampled.densities");
  EXPECT_EQ(field({Form::kSampled, 0, 0, 1, 2, {5e-324, 5e-324}}), "l.sampled.densities");
  EXPECT_EQ(field({Form::kSampled, 0, 0, 1, 2, {0, 1, -1}}), "l.sampled.densities[2]");
}

}  // namespace
}  // namespace mane::styling
