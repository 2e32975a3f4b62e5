// Properties of the batched motion, for float and double and every instruction set:
//   oracle        equals the reference, hair by hair, for all equations and settings
//   independence  a hair's bits depend on nothing in other lanes or blocks, nor on their order
//   packing       directions and rates go in and come out; turning turns them; steps scale with dt
//   nodes         are those of the directions

#include "beam/motion.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>

#include "beam/test_motion.h"
#include "beam/test_motion_reference.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::Moving;
using fixtures::OwnHair;
using fixtures::Random;

const Hull kHull{{0.01, -0.02, 0.005}, {0.08, 0.11, 0.095}};

template <typename T>
class MotionTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(MotionTest, fixtures::Numbers);

// Settings of every kind.
std::vector<MotionSettings> AllSettings(int segments) {
  std::vector<MotionSettings> all;
  for (int bits = 0; bits < 64; ++bits) {
    MotionSettings& settings = all.emplace_back();
    settings.equations = bits & 1 ? Equations::kPolar : Equations::kAcross;
    settings.bounded = bits & 2;
    settings.clamped = bits & 4;
    if (bits & 8) {
      settings.hull = kHull;
      settings.alpha = -0.3;
      settings.epsilon.assign(segments, 0.2F);
      settings.epsilon.back() = 1;
      settings.avoid_hull = bits & 1 || bits & 16;
    }
    if (bits & 16) settings.largest_turn.assign(segments, 0.5F);
    if (bits & 32) settings.fluctuation = 0.1, settings.seed = bits;
  }
  return all;
}

TYPED_TEST(MotionTest, EqualsTheReference) {
  using T = TypeParam;
  constexpr int kSegments = 6;
  const bool single = std::is_same_v<T, float>;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(31);
    int number = 0, far = 0, compared = 0;
    for (const MotionSettings& settings : AllSettings(kSegments)) {
      SCOPED_TRACE(testing::Message() << "settings " << number++);
      std::vector<OwnHair> hairs;
      for (int i = 0; i < 21; ++i) hairs.push_back(fixtures::AnyHair(random, kSegments, kHull));
      const Vector3d gravity(0, -9.81, 0), wind = random.Vector(3);
      const double dt = random.Uniform(0.005, 0.05);
      Moving<T> moving(hairs, settings, gravity);
      MotionDrive drive = fixtures::AnyDrive(random, dt);
      if (number % 2 == 0) drive.frame = 30;
      std::optional<Hull> hull;
      if (settings.hull) hull = Lifted(*settings.hull, std::numeric_limits<T>::epsilon());
      std::vector<fixtures::ReferenceHair> expected;
      for (int i = 0; i < moving.count(); ++i) {
        const auto e = random.Directions(kSegments), rates = random.Directions(kSegments);
        moving.Set(i, e, rates, drive.duration_before);
        std::vector<Vector3d> steps;
        for (const Vector3d& rate : rates) steps.emplace_back(drive.duration_before * rate);
        expected.push_back(fixtures::Begin(e, steps));
        fixtures::ReferenceStep(hairs[i].Show(), i, gravity, settings, drive, wind, hull,
                                &expected.back());
      }
      moving.Step(kernels, drive, wind);
      const double tolerance = single ? 1e-4 : 1e-9;
      for (int i = 0; i < moving.count(); ++i) {
        const auto e = moving.Directions(i), steps = moving.Steps(i);
        const auto expected_steps = fixtures::StepsOf(settings, expected[i]);
        // One decision (inside or not, near or not, beyond a turn or not) may fall the other way in
        // float32; what is beyond it on that hair differs then.
        for (int s = 0; s < kSegments; ++s) {
          ++compared;
          const Vector3d right = settings.equations == Equations::kPolar
                                     ? DirectionOf(expected[i].angles[s].t, expected[i].angles[s].f)
                                     : expected[i].e[s];
          const double error = (e[s] - right).norm();
          if (single && error > tolerance) {
            ++far;
            break;
          }
          ASSERT_LT(error, tolerance) << "hair " << i << " segment " << s;
          ASSERT_LT((steps[s] - expected_steps[s]).norm(), 20 * tolerance)
              << "hair " << i << " segment " << s;
        }
      }
    }
    EXPECT_LT(far, 0.002 * compared);
  });
}

TYPED_TEST(MotionTest, EqualsTheReferenceOverManySteps) {
  using T = TypeParam;
  constexpr int kSegments = 8;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
      Random random(8);
      MotionSettings settings;
      settings.equations = equations;
      std::vector<OwnHair> hairs;
      for (int i = 0; i < 5; ++i) hairs.push_back(fixtures::AnyHair(random, kSegments, kHull));
      const Vector3d gravity(0, -9.81, 0);
      Moving<T> moving(hairs, settings, gravity);
      std::vector<fixtures::ReferenceHair> expected;
      const std::vector<Vector3d> still(kSegments, Vector3d::Zero());
      for (const OwnHair& hair : hairs) {
        expected.push_back(fixtures::Begin(hair.rest, still));
      }
      for (int step = 0; step < 240; ++step) {
        const double t = step / 120.0;
        MotionDrive drive = fixtures::Still(gravity, 1.0 / 120);
        const auto turn = [](double at) { return Vector3d(0, 0.6 * std::sin(5 * at), 0); };
        const auto spin = [](double at) { return Vector3d(0, 3 * std::cos(5 * at), 0); };
        drive.head.q = math::FromRotationVector(turn(t));
        drive.spin = spin(t), drive.spin_before = spin(t - 1.0 / 120);
        moving.Step(kernels, drive);
        for (size_t i = 0; i < hairs.size(); ++i) {
          fixtures::ReferenceStep(hairs[i].Show(), static_cast<int>(i), gravity, settings, drive,
                                  Vector3d::Zero(), {}, &expected[i]);
        }
      }
      for (size_t i = 0; i < hairs.size(); ++i) {
        for (int s = 0; s < kSegments; ++s) {
          const double error =
              (moving.Directions(static_cast<int>(i))[s] - expected[i].e[s]).norm();
          EXPECT_LT(error, (std::is_same_v<T, float> ? 2e-4 : 1e-10)) << i << " " << s;
        }
      }
    }
  });
}

// A block alone, last or among others, in any order of stepping.
TYPED_TEST(MotionTest, HairsDoNotDependOnOthers) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(77);
    MotionSettings settings;
    settings.hull = kHull;
    settings.epsilon.assign(5, 0.1F);
    settings.largest_turn.assign(5, 0.7F);
    std::vector<OwnHair> hairs;
    for (int i = 0; i < 50; ++i) hairs.push_back(fixtures::AnyHair(random, 5, kHull));
    Moving<T> all(hairs, settings);
    std::vector<OwnHair> reversed(hairs.rbegin(), hairs.rend());
    Moving<T> other(reversed, settings);
    for (int step = 0; step < 30; ++step) {
      const MotionDrive drive = fixtures::AnyDrive(random, 1.0 / 60);
      all.Step(kernels, drive);
      const simd::Row<T> calm[3] = {};
      for (int block = other.batch().blocks() - 1; block >= 0; --block) {
        other.batch().Step(kernels, block, drive, calm, other.state());
      }
    }
    for (int i = 0; i < 50; ++i) {
      const auto a = all.Directions(i), b = other.Directions(49 - i);
      ASSERT_EQ(std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])), 0) << i;
    }
  });
}

// What B15 draws belongs to a hair's number, not to its block's place in time.
TYPED_TEST(MotionTest, FluctuationIsTheSameInAnyOrder) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(78);
    MotionSettings settings;
    settings.fluctuation = 0.2;
    std::vector<OwnHair> hairs;
    for (int i = 0; i < 50; ++i) hairs.push_back(fixtures::AnyHair(random, 5, kHull));
    Moving<T> forward(hairs, settings), backward(hairs, settings);
    const simd::Row<T> calm[3] = {};
    for (int step = 0; step < 30; ++step) {
      MotionDrive drive = fixtures::AnyDrive(random, 1.0 / 60);
      drive.frame = step;
      forward.Step(kernels, drive);
      for (int block = backward.batch().blocks() - 1; block >= 0; --block) {
        backward.batch().Step(kernels, block, drive, calm, backward.state());
      }
    }
    ASSERT_EQ(
        std::memcmp(forward.state().data(), backward.state().data(), forward.state().size_bytes()),
        0);
  });
}

TYPED_TEST(MotionTest, StatesGoInAndComeOut) {
  using T = TypeParam;
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    Random random(3);
    MotionSettings settings;
    settings.equations = equations;
    std::vector<OwnHair> hairs;
    for (int i = 0; i < 18; ++i) hairs.push_back(fixtures::AnyHair(random, 4, kHull));
    Moving<T> moving(hairs, settings);
    const Eigen::Matrix3d turn = math::FromRotationVector(random.Vector(1)).toRotationMatrix();
    std::vector<std::vector<Vector3d>> e, rates;
    for (int i = 0; i < 18; ++i) {
      e.push_back(random.Directions(4)), rates.push_back(random.Directions(4));
      moving.Set(i, e[i], rates[i], 0.02);
    }
    for (const bool turned : {false, true}) {
      if (turned) moving.batch().Rotate(turn, moving.state());
      for (int i = 0; i < 18; ++i) {
        std::vector<Vector3d> out(4), out_rates(4);
        moving.batch().GetHair(i, 0.02, moving.state(), out, out_rates);
        for (int s = 0; s < 4; ++s) {
          const Vector3d across = rates[i][s] - rates[i][s].dot(e[i][s]) * e[i][s];
          EXPECT_LT((out[s] - (turned ? turn * e[i][s] : e[i][s])).norm(), 1e-6);
          EXPECT_LT((out_rates[s] - (turned ? turn * across : across)).norm(), 3e-5);
        }
      }
    }
  }
}

// A rate goes on whatever the steps' durations.
TYPED_TEST(MotionTest, StepsMayDiffer) {
  using T = TypeParam;
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    MotionSettings settings;
    settings.equations = equations;
    settings.clamped = false;
    Moving<T> moving({fixtures::Free(1, Vector3d::UnitZ(), 1)}, settings);
    const Vector3d e = Vector3d::UnitZ(), rate = 0.1 * Vector3d::UnitX();
    moving.Set(0, std::span(&e, 1), std::span(&rate, 1), 0.01);
    double time = 0, before = 0.01;
    for (const double dt : {0.01, 0.02, 0.005, 0.02}) {
      MotionDrive drive = fixtures::Still(Vector3d::Zero(), dt);
      drive.duration_before = before;
      moving.Step(KernelsFor<T>(simd::Best()), drive);
      time += dt, before = dt;
    }
    EXPECT_NEAR(fixtures::Angle(e, moving.Directions(0)[0]), 0.1 * time, 1e-6);
  }
}

TYPED_TEST(MotionTest, NodesAreThoseOfTheDirections) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
      Random random(5);
      MotionSettings settings;
      settings.equations = equations;
      std::vector<OwnHair> hairs;
      for (int i = 0; i < 20; ++i) hairs.push_back(fixtures::AnyHair(random, 7, kHull));
      const Moving<T> moving(hairs, settings);
      const math::Pose head{random.Vector(1), math::FromRotationVector(random.Vector(1))};
      for (int i = 0; i < 20; ++i) {
        const auto nodes = moving.Nodes(kernels, i, head), e = moving.Directions(i);
        Vector3d p = head.q * hairs[i].root;
        for (int s = 0; s <= 7; ++s) {
          EXPECT_LT((nodes[s] - p).norm(), 1e-6);
          if (s < 7) p += hairs[i].segment_length * e[s];
        }
      }
    }
  });
}

}  // namespace
}  // namespace mane::beam
