// Properties of bending in batches, for float and double and every instruction set of this machine:
//   oracle        equals Bend, hair by hair
//   independence  a lane's bits depend on nothing in other lanes, nor on its place
//   hull          no node is inside, whatever hair, hull and forces
//   lengths       segments keep theirs

#include "beam/bend_batch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <vector>

#include "beam/test_every_isa.h"
#include "beam/test_hairs.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::BendAll;
using fixtures::Random;

template <typename T>
class BendBatchTest : public fixtures::EveryIsaTest<T> {
 protected:
  static constexpr double kEpsilon = std::numeric_limits<T>::epsilon();
};
TYPED_TEST_SUITE(BendBatchTest, fixtures::Numbers);

std::vector<BendHair> AnyHairs(Random& random, const Hull& hull, int count, double length, int k) {
  std::vector<BendHair> hairs;
  for (int i = 0; i < count; ++i) {
    hairs.emplace_back(fixtures::AnyHair(random, hull, length * random.Uniform(0.3, 1), k));
    hairs.back().forces = static_cast<uint32_t>(random.Uniform(0, 64));
  }
  return hairs;
}

// Hair at a place where two things are as good (a parting, the edge of a half-space, the lowest
// point of a hull) may do either in rounded numbers: all but one of a hundred are compared.
TYPED_TEST(BendBatchTest, EqualsTheReference) {
  using T = TypeParam;
  const double tolerance = std::is_same_v<T, float> ? 1e-4 : 1e-9;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(1);
    int close = 0, all = 0;
    for (const int k : {2, 3, 20, 50}) {
      for (int trial = 0; trial < 8; ++trial) {
        const Hull hull = random.AnyHull();
        const double length = 3 * hull.radii.maxCoeff();
        const BendField field = fixtures::AnyField(random, hull, 6);
        const std::vector<double> weights = TurnWeights(k);
        const BendBatch<T> batch(weights, field, hull);
        const auto hairs = AnyHairs(random, Lifted(hull, 1e-7), 37, length, k);
        const auto bent = BendAll(kernels, batch, hull, hairs);
        for (size_t h = 0; h < hairs.size(); ++h) {
          const auto expected = Bend(hairs[h], field, weights, hull);
          double error = 0;
          for (int i = 0; i <= k; ++i) {
            error = std::max(error, (bent[h][i] - expected[i]).norm());
          }
          close += error < tolerance * length ? 1 : 0, ++all;
        }
      }
    }
    EXPECT_GT(close, 0.99 * all) << close << " of " << all;
  });
}

TYPED_TEST(BendBatchTest, ALaneDependsOnNothingElse) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(2);
    const Hull hull = random.AnyHull();
    const BendField field = fixtures::AnyField(random, hull, 4);
    const BendBatch<T> batch(TurnWeights(20), field, hull);
    const auto hairs = AnyHairs(random, Lifted(hull, 1e-7), 64, 3 * hull.radii.maxCoeff(), 20);
    const auto together = BendAll(kernels, batch, hull, hairs);
    for (size_t h = 0; h < hairs.size(); ++h) {
      const auto alone = BendAll(kernels, batch, hull, std::span(hairs).subspan(h, 1));
      for (size_t i = 0; i < alone[0].size(); ++i) EXPECT_EQ(alone[0][i], together[h][i]);
    }
  });
}

// Also of nodes as they are told: rounded to float in the head frame.
TYPED_TEST(BendBatchTest, NoNodeIsInsideAndSegmentsKeepTheirLength) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(3);
    for (int trial = 0; trial < 300; ++trial) {
      const Hull hull = random.AnyHull(), lifted = Lifted(hull, TestFixture::kEpsilon);
      const int k = trial % 3 == 0 ? 7 : trial % 3 == 1 ? 20 : 120;
      const double length = random.LogUniform(0.01, 10) * hull.radii.maxCoeff();
      BendField field = fixtures::AnyField(random, hull, 3);
      Force inward;  // Presses all hair to the middle of the head.
      inward.kind = Force::Kind::kToward;
      inward.point = hull.center;
      inward.strength = random.LogUniform(1, 1e4);
      field.forces.emplace_back(inward);
      const BendBatch<T> batch(TurnWeights(k), field, lifted);
      auto hairs = AnyHairs(random, lifted, 48, length, k);
      for (size_t h = 0; h < hairs.size(); h += 3) hairs[h].direction = random.Direction();
      for (size_t h = 1; h < hairs.size(); h += 6) hairs[h].direction = -hairs[h].direction;
      for (size_t h = 2; h < hairs.size(); h += 7) {  // As soft as hair can be.
        hairs[h].softness = SoftnessOf(1, hairs[h].segment_length, 1e-15, k);
      }
      const auto bent = BendAll(kernels, batch, hull, hairs);
      const double far = hull.center.cwiseAbs().maxCoeff() + hull.radii.maxCoeff() + length;
      for (size_t h = 0; h < bent.size(); ++h) {
        const double d = hairs[h].segment_length;
        for (size_t i = 0; i < bent[h].size(); ++i) {
          ASSERT_TRUE(bent[h][i].allFinite());
          ASSERT_GE(hull.At(bent[h][i].template cast<float>().template cast<double>()), 0)
              << "trial " << trial << " hair " << h << " node " << i;
          if (i == 0) continue;
          EXPECT_NEAR((bent[h][i] - bent[h][i - 1]).norm(), d,
                      4 * TestFixture::kEpsilon * (far + d));
        }
      }
    }
  });
}

// In a plane that nearly lies along the hull the way out would be long.
TYPED_TEST(BendBatchTest, WhatGrazesTheHullTurnsByLittle) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(5);
    const Hull hull{Vector3d(0.01, -0.02, 0.005), Vector3d(0.08, 0.11, 0.095)};
    const Hull lifted = Lifted(hull, TestFixture::kEpsilon);
    constexpr double kSinking = 0.005, kLength = 1e-3 * 0.08;
    for (int trial = 0; trial < 100; ++trial) {
      BendHair hair = fixtures::AnyHair(random, lifted, kLength, 1);
      const Vector3d n = hair.direction, u = n.unitOrthogonal();
      const Vector3d sinking = (n.cross(u) - kSinking * n).normalized();
      hair.direction = u;
      hair.softness = 1;
      BendField field;
      field.gravity = 10 * sinking;
      const std::vector<double> weights = {1};
      const auto bent = BendAll(kernels, BendBatch<T>(weights, field, lifted), hull, {&hair, 1});
      const Vector3d free = (u + 10 * sinking).normalized();
      ASSERT_LT(lifted.At(hair.root + kLength * free), 0);
      EXPECT_LT(((bent[0][1] - bent[0][0]) / kLength - free).norm(), 2 * kSinking);
    }
  });
}

TEST(BendLengthTest, SegmentsKeepTheirLengthToTheNumbersPrecision) {
  Random random(4);
  const Hull hull{Vector3d::Zero(), Vector3d(0.08, 0.11, 0.1)};
  const BendField field = fixtures::AnyField(random, hull, 2);
  const auto hairs = AnyHairs(random, Lifted(hull, 1e-7), 64, 0.3, 20);
  const BendBatch<double> precise(TurnWeights(20), field, hull);
  const BendBatch<float> fast(TurnWeights(20), field, hull);
  const auto largest = [&](const auto& bent) {
    double error = 0;
    for (size_t h = 0; h < bent.size(); ++h) {
      for (size_t i = 1; i < bent[h].size(); ++i) {
        const double d = hairs[h].segment_length;
        error = std::max(error, std::abs((bent[h][i] - bent[h][i - 1]).norm() - d) / (20 * d));
      }
    }
    return error;
  };
  EXPECT_LT(largest(BendAll(KernelsFor<double>(simd::Best()), precise, hull, hairs)), 1e-14);
  EXPECT_LT(largest(BendAll(KernelsFor<float>(simd::Best()), fast, hull, hairs)), 1e-6);
}

}  // namespace
}  // namespace mane::beam
