// Laws of the wind field:
//   statistics   mean, rms of gusts and eddies are what was asked for
//   band         near places feel the same eddy, far ones another; nothing is faster than its band
//   flow         eddies have no divergence
//   seed         decides everything; the same seed gives the same bits, wherever the origin is

#include "head/wind.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "math/random.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using rod::layout::kLanes;
using Rows = std::array<rod::Row<float>, 3>;

Vector3d At(const WindField& field, double t, const Vector3d& origin,
            const Vector3d& offset = Vector3d::Zero()) {
  Rows places, velocity;
  for (int i = 0; i < 3; ++i) {
    for (float& lane : places[i].lane) lane = static_cast<float>(offset[i]);
  }
  field.Evaluate(t, origin, places, velocity);
  return {velocity[0].lane[3], velocity[1].lane[3], velocity[2].lane[3]};
}

TEST(WindFieldTest, WithoutVariationItIsTheMeanEverywhere) {
  const WindField field({3, -1, 2}, {});
  EXPECT_FALSE(field.turbulent());
  EXPECT_EQ(field.Mean(17), Vector3d(3, -1, 2));
  EXPECT_EQ(At(field, 5, {1, 2, 3}), Vector3d(3, -1, 2));
}

TEST(WindFieldTest, EddiesHaveTheSpeedThatWasAskedFor) {
  WindVariation variation{.turbulence_speed = 1.5, .turbulence_size = 0.2};
  const Vector3d mean(4, 0, 1);
  Vector3d sum = Vector3d::Zero();
  double squares = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    variation.seed = i % 40;
    math::RandomStream random(1, i);
    const Vector3d place(random.Uniform(-50, 50), random.Uniform(-50, 50), random.Uniform(-50, 50));
    const Vector3d u = At(WindField(mean, variation), random.Uniform(0, 100), place) - mean;
    sum += u;
    squares += u.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / kSamples), 1.5, 0.05);
  EXPECT_LT((sum / kSamples).norm(), 0.05);
}

TEST(WindFieldTest, GustsHaveTheStrengthAndThePeriodThatWereAskedFor) {
  const WindField field({5, 0, 0}, {.gust_strength = 0.3, .gust_period = 2, .seed = 9});
  double sum = 0, squares = 0;
  int crossings = 0;
  constexpr int kSamples = 200000;
  constexpr double kStep = 0.01;
  double last = 0;
  for (int i = 0; i < kSamples; ++i) {
    const Vector3d u = field.Mean(kStep * i);
    EXPECT_EQ(u.y(), 0);
    const double change = u.x() / 5 - 1;
    sum += change;
    squares += change * change;
    crossings += last * change < 0;
    last = change;
  }
  EXPECT_NEAR(sum / kSamples, 0, 0.01);
  EXPECT_NEAR(std::sqrt(squares / kSamples), 0.3, 0.01);
  // A wave crosses zero twice a period, and all periods lie between 1 and 4 s.
  const double period = 2 * kSamples * kStep / crossings;
  EXPECT_GT(period, 1);
  EXPECT_LT(period, 4);
}

TEST(WindFieldTest, NearPlacesFeelTheSameEddyFarOnesAnother) {
  WindVariation variation{.turbulence_speed = 1, .turbulence_size = 0.2};
  double near = 0, far = 0;
  constexpr int kSamples = 2000;
  for (int i = 0; i < kSamples; ++i) {
    variation.seed = i;
    const WindField field(Vector3d::Zero(), variation);
    const Vector3d u = At(field, 0, {0, 0, 0});
    near += u.dot(At(field, 0, {0, 0, 0}, {0.01, 0, 0})) / kSamples;
    far += u.dot(At(field, 0, {0, 0, 0}, {0, 3, 0})) / kSamples;
  }
  EXPECT_GT(near, 0.9);
  EXPECT_LT(std::abs(far), 0.1);
}

TEST(WindFieldTest, EddiesHaveNoDivergence) {
  const WindField field({1, 0, 0}, {.turbulence_speed = 1, .turbulence_size = 0.5, .seed = 4});
  constexpr double h = 0.02;
  for (int i = 0; i < 20; ++i) {
    const Vector3d place(0.1 * i, 0, 0);
    double divergence = 0, slope = 0;
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = h * Vector3d::Unit(k);
      const Vector3d d = (At(field, 1, place, step) - At(field, 1, place, -step)) / (2 * h);
      divergence += d[k];
      slope += d.norm();
    }
    EXPECT_LT(std::abs(divergence), 0.02 * slope + 0.01) << i;
  }
}

TEST(WindFieldTest, TheSeedDecidesAndTheOriginOnlyShifts) {
  WindVariation variation{.gust_strength = 0.2, .turbulence_speed = 1, .seed = 7};
  const WindField a({2, 0, 0}, variation), b({2, 0, 0}, variation);
  EXPECT_EQ(At(a, 3, {1, 2, 3}), At(b, 3, {1, 2, 3}));
  variation.seed = 8;
  EXPECT_GT((At(a, 3, {1, 2, 3}) - At(WindField({2, 0, 0}, variation), 3, {1, 2, 3})).norm(), 0.01);
  EXPECT_LT((At(a, 3, {1, 2, 3}) - At(a, 3, {0.5, 2, 3}, {0.5, 0, 0})).norm(), 1e-4);
  // A kilometre away and an hour later as smooth as here.
  const Vector3d far(1000, 0, 500);
  EXPECT_LT((At(a, 3600, far) - At(a, 3600, far, {1e-4, 0, 0})).norm(), 0.02);
}

}  // namespace
}  // namespace mane::head
