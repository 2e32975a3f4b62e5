// Joints and fluctuation of moving hair, for float and double and every instruction set:
//   joints        turn no further than they may
//   fluctuation   is even, rare, keeps within the joints, adds no motion

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <type_traits>
#include <vector>

#include "beam/motion.h"
#include "beam/test_motion.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::Angle;
using fixtures::Free;
using fixtures::Moving;
using fixtures::OwnHair;
using fixtures::Random;
using fixtures::Still;
using std::numbers::pi;

const Hull kHull{{0.01, -0.02, 0.005}, {0.08, 0.11, 0.095}};

template <typename T>
class MotionJointsTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(MotionJointsTest, fixtures::Numbers);

TYPED_TEST(MotionJointsTest, JointsTurnNoFurtherThanTheyMay) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
      Random random(64);
      MotionSettings settings;
      settings.equations = equations;
      settings.fluctuation = 0.3;
      settings.largest_turn = {3, 0, 0.02F, 0.17F, 0.26F, 1, 2, static_cast<float>(pi)};
      std::vector<OwnHair> hairs;
      for (int i = 0; i < 20; ++i) hairs.push_back(fixtures::AnyHair(random, 8, kHull));
      Moving<T> moving(hairs, settings);
      int at_limit = 0;
      for (int step = 0; step < 60; ++step) {
        MotionDrive drive = fixtures::AnyDrive(random, 0.02);
        drive.frame = step;
        moving.Step(kernels, drive);
        for (int i = 0; i < 20; ++i) {
          const auto e = moving.Directions(i);
          for (int s = 1; s < 8; ++s) {
            const double turn = Angle(e[s - 1], e[s]), most = settings.largest_turn[s];
            // Float32 resolves an angle by its cosine to 1e-7 over its sine.
            ASSERT_LE(turn, most + (std::is_same_v<T, float> ? 2e-5 : 1e-8)) << s;
            at_limit += turn > most - 1e-4 && s < 7;
          }
        }
      }
      EXPECT_GT(at_limit, 1000);
    }
  });
}

TEST(MotionFluctuationTest, IsEvenAndRare) {
  constexpr double kLargest = 0.3;
  MotionSettings settings;
  settings.fluctuation = kLargest;
  settings.clamped = false;
  settings.seed = 5;
  std::vector<OwnHair> hairs(640, Free(10, {0.3, -1, 0.4}, 1));
  double sum[2] = {}, squares[2] = {}, product = 0;
  int count = 0;
  for (int frame = 0; frame < 30; ++frame) {
    Moving<double> moving(hairs, settings);
    MotionDrive drive = Still(Vector3d::Zero(), 0.01);
    drive.frame = frame;
    moving.Step(fixtures::Kernels(), drive);
    for (int i = 0; i < moving.count(); ++i) {
      const Vector3d e = hairs[i].rest[0], u = e.unitOrthogonal(), v = e.cross(u);
      for (const Vector3d& now : moving.Directions(i)) {
        if (frame % 10 != 0) {
          ASSERT_LT((now - e).norm(), 1e-12);
          continue;
        }
        // Turned by 2 atan(size / 2).
        const double size = 2 * std::tan(Angle(now, e) / 2);
        const Vector3d along = size * (now - now.dot(e) * e).normalized();
        ASSERT_LE(size, kLargest * std::sqrt(2) * (1 + 1e-9));
        const double part[2] = {along.dot(u), along.dot(v)};
        for (int axis = 0; axis < 2; ++axis) {
          sum[axis] += part[axis], squares[axis] += part[axis] * part[axis];
        }
        product += part[0] * part[1];
        ++count;
      }
    }
  }
  // Means of 19,200 draws of variance kLargest^2 / 3, five deviations wide.
  const double variance = kLargest * kLargest / 3, wide = 5 / std::sqrt(count);
  ASSERT_EQ(count, 3 * 6400);
  for (int axis = 0; axis < 2; ++axis) {
    EXPECT_NEAR(sum[axis] / count, 0, wide * std::sqrt(variance));
    EXPECT_NEAR(squares[axis] / count, variance, wide * variance);
  }
  EXPECT_NEAR(product / count, 0, wide * variance);
}

TEST(MotionFluctuationTest, AddsNoMotion) {
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    MotionSettings settings;
    settings.equations = equations;
    settings.bounded = false;
    settings.fluctuation = 0.3;
    Moving<double> moving(std::vector<OwnHair>(16, Free(10, {0.3, -1, 0.4}, 1)), settings);
    std::vector<Vector3d> before = moving.Directions(3);
    for (int frame = 0; frame < 1000; ++frame) {
      MotionDrive drive = Still(Vector3d::Zero(), 0.02);
      drive.frame = frame;
      moving.Step(fixtures::Kernels(), drive);
      for (const Vector3d& step : moving.Steps(3)) ASSERT_LT(step.norm(), 1e-12);
      const auto now = moving.Directions(3);
      // The clamped one apart.
      for (int s = 1; s < 10; ++s) {
        ASSERT_EQ((now[s] - before[s]).norm() > 1e-9, frame % 10 == 0) << frame;
      }
      before = now;
    }
    // What moves goes on as fast.
    const std::vector<Vector3d> rates(10, {0, 0.1, 0.3});
    moving.Set(0, std::vector<Vector3d>(10, Vector3d::UnitX()), rates, 0.02);
    if (equations == Equations::kPolar) continue;  // Angles go on as fast, directions need not.
    for (int frame = 0; frame < 1000; ++frame) {
      MotionDrive drive = Still(Vector3d::Zero(), 0.02);
      drive.frame = frame;
      moving.Step(fixtures::Kernels(), drive);
    }
    EXPECT_NEAR(moving.Steps(0)[5].norm(), 0.02 * rates[5].norm(), 1e-9);
  }
}

}  // namespace
}  // namespace mane::beam
