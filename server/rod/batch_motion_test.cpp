// What moving strands in batches guarantees, for float and double and every instruction set:
//   bounded    no motion, step, damping or hair makes a number non-finite, a strand longer than it
//              is, or faster than a whip
//   rest       hair at rest on a head that does not move stays there
//   energy     never grows on a clamp at rest without weight, at any step
//   precision  float32 follows double to 1e-5 L over two seconds of shaking

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "rod/chain.h"
#include "rod/energy.h"
#include "rod/statics.h"
#include "rod/test_batches.h"
#include "rod/test_motions.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Hair;
using fixtures::Packed;
using fixtures::Random;
using fixtures::State;

template <typename T>
class BatchMotionTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(BatchMotionTest, fixtures::Numbers);

// Any hair on any root, N from 1 to 12, damped or not.
Strand AnyHair(Random& random, int i) {
  const Hair& hair = fixtures::AppendixB()[i % 4];
  Strand strand = fixtures::MakeStrand(hair, random.Uniform(0.02, 0.5), 1 + i / 4 % 12);
  for (double& length : strand.length) length *= random.Uniform(0.5, 1.5);
  strand.stiffness *= std::pow(10, random.Uniform(-2, 2));
  if (i % 3 == 0) strand.internal_friction = 0;
  if (i % 5 == 0) strand.air_drag = 0;
  return strand;
}

TYPED_TEST(BatchMotionTest, IsBoundedUnderHostileMotion) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(2024);
    Packed<T> packed;
    for (int i = 0; i < 1536; ++i) {
      const Strand strand = AnyHair(random, i);
      packed.Add(strand, random.AnyRoot(), State(strand));
    }
    packed.Pack();
    math::Pose pose;
    double fastest = 0;
    for (int i = 0; i < 120; ++i) {
      const double dt = i % 7 == 0 ? 0.1 : random.Uniform(1.0 / 240, 1.0 / 30);
      const math::Pose next = fixtures::Hostile(random, pose, i);
      Surroundings air;
      air.gravity = random.Vector(20);
      air.wind = i % 11 == 0 ? random.Vector(50) : Vector3d::Zero();
      air.air_drag_scale = i % 2;
      ASSERT_EQ(packed.Step(kernels, {pose, next, dt}, air), 0u) << "step " << i;
      const double turn = math::RotationVector(next.q * pose.q.conjugate()).norm();
      fastest = std::max(fastest, ((next.p - pose.p).norm() + 0.8 * turn) / dt);
      pose = next;
      if (i % 10 != 9) continue;
      for (int s = 0; s < packed.size(); s += 7) {
        const State state = packed.Get(s);
        const Strand& strand = packed.strand(s);
        for (const Vector3d& u : state.velocity) ASSERT_LT(u.norm(), 60 * fastest) << s;
        const auto frames = ElementFrames(strand, packed.root(s), state.theta);
        for (int Q = 0; Q < strand.elements(); ++Q) {
          ASSERT_LE((frames[Q + 1].r - frames[Q].r).norm(), strand.length[Q] * (1 + 1e-9)) << s;
        }
      }
    }
  });
}

TYPED_TEST(BatchMotionTest, EnergyNeverGrowsOnAClampAtRest) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const double dt : {1e-3, 1.0 / 60, 0.1}) {
      Random random(77);
      Packed<T> packed;
      for (int i = 0; i < 96; ++i) {
        const Strand strand = AnyHair(random, i);
        packed.Add(strand, random.AnyRoot(), random.AnyState(strand, 1, 10, 2));
      }
      packed.Pack();
      const auto energy = [&](int i) {
        const State state = packed.Get(i);
        const Strand& strand = packed.strand(i);
        return ElasticEnergy(strand, state.theta) + KineticEnergy(strand, state.velocity);
      };
      std::vector<double> last;
      for (int i = 0; i < packed.size(); ++i) last.push_back(energy(i));
      const std::vector<double> first = last;
      Surroundings air;
      air.gravity.setZero();
      const math::Pose pose = random.Pose();
      for (int step = 0; step < 40; ++step) {
        ASSERT_EQ(packed.Step(kernels, {pose, pose, dt}, air), 0u);
        for (int i = 0; i < packed.size(); ++i) {
          const double now = energy(i);
          // Float32 holds an energy to some 1e-6 of what there was.
          const double rounding = (std::is_same_v<T, float> ? 1e-5 : 1e-12) * first[i];
          ASSERT_LE(now, last[i] + rounding) << "strand " << i << " step " << step << " dt " << dt;
          last[i] = now;
        }
      }
    }
  });
}

TYPED_TEST(BatchMotionTest, HairAtRestStaysAtRest) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const double dt : {1.0 / 60, 1.0 / 240}) {
      for (const double friction : {0.0, 1.0}) {
        for (const double length : {0.1, 0.25, 0.5}) {
          SCOPED_TRACE(testing::Message()
                       << "dt=" << dt << " friction=" << friction << " L=" << length);
          Random random(3);
          Packed<T> packed;
          for (int i = 0; i < 32; ++i) {
            const Hair& hair = fixtures::AppendixB()[i % 4];
            // Long coils at ten elements need the friction that hair has (rod.md, Time step,
            // Measured).
            const bool five = i % 8 < 4 || (i % 4 >= 2 && length > 0.3 && friction == 0);
            Strand strand = fixtures::MakeStrand(hair, length, five ? 5 : 10);
            strand.internal_friction *= friction;
            Vector3d out = random.Direction();
            out.y() = 0.7 * std::abs(out.y());
            const math::Pose root{random.Vector(0.1), Eigen::Quaterniond::FromTwoVectors(
                                                          Vector3d::UnitX(), out.normalized())};
            State state(strand);
            ASSERT_TRUE(SolveRestShape(strand, root, {0, -9.81, 0}, state.theta).converged);
            packed.Add(strand, root, state);
          }
          packed.Pack();
          for (int i = 0; i * dt < 4; ++i) ASSERT_EQ(packed.Step(kernels, {{}, {}, dt}, {}), 0u);
          for (int i = 0; i < packed.size(); ++i) {
            const auto tip = [&](const State& state) {
              return fixtures::Tip(packed.strand(i), packed.root(i), state.theta);
            };
            EXPECT_LT((tip(packed.Get(i)) - tip(packed.start(i))).norm(), 1e-4 * length) << i;
          }
        }
      }
    }
  });
}

TEST(BatchPrecisionTest, FloatFollowsDouble) {
  for (const simd::Isa isa : simd::Supported()) {
    SCOPED_TRACE(std::string(simd::Name(isa)));
    for (const Hair& hair : fixtures::AppendixB()) {
      for (const int N : {5, 10}) {
        SCOPED_TRACE(testing::Message() << hair.name << " N=" << N);
        Packed<float> floats;
        Packed<double> doubles;
        Random random(1);
        for (int i = 0; i < 16; ++i) {
          const Strand strand = fixtures::MakeStrand(hair, 0.2, N);
          // Hair that leaves the head downwards and outwards; upright smooth hair buckles, and
          // which way is chance.
          const Eigen::Quaterniond down = Eigen::Quaterniond::FromTwoVectors(
              Vector3d::UnitX(), Vector3d(0.5 * std::cos(i), -1, 0.5 * std::sin(i)));
          const math::Pose root{random.Vector(0.1), down};
          floats.Add(strand, root, State(strand));
          doubles.Add(strand, root, State(strand));
        }
        floats.Pack();
        doubles.Pack();
        const auto pose = [](double t) -> math::Pose {
          return {{0.03 * std::sin(2 * M_PI * 2 * t), 0, 0},
                  math::FromRotationVector({0, 0.35 * std::sin(2 * M_PI * 1.5 * t), 0})};
        };
        double sum = 0;
        int count = 0;
        for (int i = 0; i < 120; ++i) {
          const ClampMotion motion{pose(i / 60.0), pose((i + 1) / 60.0), 1 / 60.0};
          ASSERT_EQ(floats.Step(KernelsFor<float>(isa), motion, {}), 0u);
          ASSERT_EQ(doubles.Step(KernelsFor<double>(isa), motion, {}), 0u);
          for (int s = 0; s < 16; ++s, ++count) {
            const auto tip = [&](const State& state) {
              return fixtures::Tip(floats.strand(s), floats.root(s), state.theta);
            };
            sum += (tip(floats.Get(s)) - tip(doubles.Get(s))).squaredNorm();
          }
        }
        EXPECT_LT(std::sqrt(sum / count), 1e-5 * 0.2);
      }
    }
  }
}

}  // namespace
}  // namespace mane::rod
