// Divided recurrences (B12) are bounded: no step is longer than one radian, than the one before it
// and than the head's own turn; no input makes a number that is not finite, or a segment of another
// length, for float and double and every instruction set.

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "beam/motion.h"
#include "beam/test_motion.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::Moving;
using fixtures::OwnHair;
using fixtures::Random;

const Hull kHull{Vector3d::Zero(), {0.08, 0.11, 0.095}};

template <typename T>
class MotionBoundedTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(MotionBoundedTest, fixtures::Numbers);

TYPED_TEST(MotionBoundedTest, NoStepIsLongerThanARadianOrWhatCameIn) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(9);
    MotionSettings settings;
    settings.clamped = false;
    std::vector<OwnHair> hairs;
    for (int i = 0; i < 32; ++i) hairs.push_back(fixtures::AnyHair(random, 5, kHull));
    Moving<T> moving(hairs, settings);
    for (int round = 0; round < 200; ++round) {
      const double dt = random.Uniform(1e-3, 0.1);
      MotionDrive drive = fixtures::Still(random.Vector(std::pow(10, random.Uniform(-2, 6))), dt);
      drive.spin = drive.spin_before = random.Vector(random.Uniform(0, 0.3) / dt);
      std::vector<std::vector<Vector3d>> before;
      for (int i = 0; i < 32; ++i) {
        const auto e = random.Directions(5), rates = random.Directions(5);
        moving.Set(i, e, rates, random.Uniform(0, 3));
        before.push_back(moving.Steps(i));
      }
      moving.Step(kernels, drive);
      for (int i = 0; i < 32; ++i) {
        const auto after = moving.Steps(i);
        for (int s = 0; s < 5; ++s) {
          const double most = std::max({1.0, before[i][s].norm(), dt * drive.spin.norm()});
          ASSERT_LE(after[s].norm(), most * (1 + 1e-5));
        }
      }
    }
  });
}

TYPED_TEST(MotionBoundedTest, NothingBreaksASegment) {
  using T = TypeParam;
  // Float32 rounds nodes of about a metre from the head's place.
  const double rounding = 2 * std::numeric_limits<T>::epsilon();
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (int kind = 0; kind < 16; ++kind) {
      SCOPED_TRACE(testing::Message() << "kind " << kind);
      Random random(100 + kind);
      MotionSettings settings;
      settings.equations = kind & 1 ? Equations::kPolar : Equations::kAcross;
      settings.clamped = kind & 2;
      if (kind & 4) settings.hull = kHull, settings.epsilon.assign(8, 0.1F);
      if (kind & 8) settings.largest_turn.assign(8, 0.3F), settings.fluctuation = 0.5;
      std::vector<OwnHair> hairs;
      for (int i = 0; i < 20; ++i) {
        OwnHair& hair = hairs.emplace_back(fixtures::AnyHair(random, 8, kHull));
        if (i % 3 == 0) hair.drag = hair.friction = 0;
        if (i % 4 == 0) hair.response.assign(8, 1e4);
        if (i % 5 == 0) hair.hold.assign(8, 0.0);
        if (i % 7 == 0) hair.root.setZero();
      }
      Moving<T> moving(hairs, settings, {0, -9.81, 0});
      for (int step = 0; step < 400; ++step) {
        MotionDrive drive =
            fixtures::AnyDrive(random, step % 3 == 0 ? 0.1 : random.Uniform(1e-3, 0.1));
        drive.duration_before = 0;
        drive.frame = step;
        const double size = std::pow(10, random.Uniform(0, 6));
        switch (step % 5) {
          case 0:  // A huge field.
            drive.gravity = random.Vector(size);
            break;
          case 1:  // The head is elsewhere.
            drive.velocity = random.Vector(1e3) / drive.duration;
            break;
          case 2:  // It spins.
            drive.spin = random.Vector(3.1 / drive.duration);
            break;
          case 3:
            moving.batch().Rotate(math::FromRotationVector(random.Vector(2)).toRotationMatrix(),
                                  moving.state());
            break;
          default:
            break;
        }
        moving.Step(kernels, drive, random.Vector(10));
        for (int i = 0; i < 20; ++i) {
          const auto nodes = moving.Nodes(kernels, i, drive.head);
          const double d = hairs[i].segment_length;
          for (size_t s = 1; s < nodes.size(); ++s) {
            const double length = (nodes[s] - nodes[s - 1]).norm();
            ASSERT_NEAR(length, d, 4 * rounding * d + rounding) << step << " " << i << " " << s;
          }
          for (const Vector3d& delta : moving.Steps(i)) ASSERT_TRUE(delta.allFinite());
        }
      }
    }
  });
}

// Directions in float32 after hours of frames are as long as at the beginning.
TEST(MotionBoundedTest, NothingDrifts) {
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    MotionSettings settings;
    settings.equations = equations;
    settings.bounded = false;
    settings.clamped = false;
    Moving<float> moving({fixtures::Free(2, {1, 0.3, 0.2}, 3)}, settings);
    const auto& kernels = KernelsFor<float>(simd::Best());
    for (int i = 0; i < 1'000'000; ++i) {
      moving.Step(kernels, fixtures::Still({1, -9, 2}, 1.0 / 60));
    }
    const auto nodes = moving.Nodes(kernels, 0);
    EXPECT_NEAR((nodes[2] - nodes[1]).norm(), moving.hair(0).segment_length, 1e-8);
    EXPECT_LT(moving.Steps(0)[1].norm(), 1);
    EXPECT_LT(std::abs(moving.Steps(0)[1].dot(moving.Directions(0)[1])), 1e-8);
  }
}

// Angles of hair that goes round and round stay where float32 resolves them.
TEST(MotionBoundedTest, AnglesStayWithinHalfATurn) {
  MotionSettings settings;
  settings.equations = Equations::kPolar;
  settings.clamped = false;
  Moving<float> moving({fixtures::Free(1, {0, 0.3, 1}, 1)}, settings);
  const Vector3d e = moving.Directions(0)[0], rate(0.7, 0, 0);
  for (const Vector3d& way : {rate, Vector3d(-rate)}) {
    moving.Set(0, std::span(&e, 1), std::span(&way, 1), 1);
    for (int i = 0; i < 1000; ++i) {
      moving.Step(KernelsFor<float>(simd::Best()), fixtures::Still(Vector3d::Zero(), 1));
      ASSERT_LE(std::abs(moving.state()[layout::kAzimuth].lane[0]), 3.1416F);
    }
  }
}

}  // namespace
}  // namespace mane::beam
