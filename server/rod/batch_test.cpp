// Properties of the batched step, for float and double and every instruction set of this machine:
//   oracle        equals Step, strand by strand, for any N, lengths, windings, clamps, airs
//   independence  a lane's bits depend on nothing in other lanes, nor on its place
//   positions     are those of the reconstructed centreline
//   packing       states go in and come out; blocks are full but for the last of each N, and of
//                 strands that are near each other
//   economy       a warm step does not allocate

#include "rod/batch.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "base/test_allocations.h"
#include "rod/chain.h"
#include "rod/test_batches.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Difference;
using fixtures::Largest;
using fixtures::Packed;
using fixtures::Random;
using fixtures::State;
using layout::kLanes;

template <typename T>
class BatchTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(BatchTest, fixtures::Numbers);

// `count` strands of N elements bent by up to `angle` [rad] each, in any state, packed.
template <typename T>
Packed<T> AnyPacked(Random& random, int count, int N, double angle) {
  Packed<T> packed;
  for (int i = 0; i < count; ++i) {
    const Strand strand = random.UnevenStrand(N, 0.2, angle);
    packed.Add(strand, random.AnyRoot(), random.AnyState(strand, 0.5, 5, 1));
  }
  packed.Pack();
  return packed;
}

TYPED_TEST(BatchTest, EqualsTheStepOfEachStrand) {
  using T = TypeParam;
  // The quadratic form is conditioned like 1e5 (twist has next to no inertia), which multiplies the
  // rounding.
  const double tolerance = std::is_same_v<T, float> ? 3e-3 : 1e-9;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(4712);
    for (const int N : {1, 2, 3, 5, 10, 16, 23}) {
      for (const double dt : {1.0 / 120, 1.0 / 30, 0.1}) {
        SCOPED_TRACE(testing::Message() << "N=" << N << " dt=" << dt);
        Packed<T> packed = AnyPacked<T>(random, 19, N, 1.5);
        const ClampMotion motion = random.AnyMotion(dt);
        const Surroundings air = random.AnyAir();
        ASSERT_EQ(packed.Step(kernels, motion, air), 0u);
        StepScratch scratch;
        for (int i = 0; i < packed.size(); ++i) {
          SCOPED_TRACE(testing::Message() << "strand " << i);
          State expected = packed.start(i);
          const State result = packed.Get(i);
          const math::Pose& root = packed.root(i);
          const ClampMotion clamp{motion.begin * root, motion.end * root, dt};
          ASSERT_TRUE(Step(packed.strand(i), clamp, air, expected.View(), scratch));
          const double rates = Largest(expected.rate), speeds = Largest(expected.velocity);
          EXPECT_LT(Difference(result.rate, expected.rate), tolerance * rates);
          EXPECT_LT(Difference(result.theta, expected.theta), tolerance * dt * rates + 1e-6);
          EXPECT_LT(Difference(result.velocity, expected.velocity), tolerance * speeds);
        }
      }
    }
  });
}

TYPED_TEST(BatchTest, EqualsTheStepAtAnyWinding) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(99);
    for (const double angle : {0.0, 1e-12, 1e-4, 1.0, 1.6, 3.0, 7.0, 20.0, 60.0, 120.0}) {
      SCOPED_TRACE(testing::Message() << "angle=" << angle);
      Packed<T> packed;
      for (int i = 0; i < kLanes; ++i) {
        // Lanes of one block wind differently.
        const double own = i % 4 == 0 ? angle : angle * random.Uniform(0, 1);
        Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[i % 4], 0.2, 4);
        State state(strand);
        for (int Q = 0; Q < 4; ++Q) {
          strand.natural[Q] = own / strand.length[Q] * random.Direction();
          state.theta[Q] = strand.length[Q] * strand.natural[Q];
        }
        packed.Add(strand, random.AnyRoot(), state);
      }
      packed.Pack();
      const ClampMotion motion = random.AnyMotion(1.0 / 60);
      ASSERT_EQ(packed.Step(kernels, motion, Surroundings{}), 0u);
      StepScratch scratch;
      for (int i = 0; i < packed.size(); ++i) {
        SCOPED_TRACE(testing::Message() << "strand " << i);
        State expected = packed.start(i);
        const State result = packed.Get(i);
        const math::Pose& root = packed.root(i);
        ASSERT_TRUE(Step(packed.strand(i), {motion.begin * root, motion.end * root, motion.dt},
                         Surroundings{}, expected.View(), scratch));
        // An angle of x radians carries an error of x ulp into every sine.
        const double ulp = std::numeric_limits<T>::epsilon();
        const double tolerance = 2e4 * ulp * (1 + angle);
        EXPECT_LT(Difference(result.velocity, expected.velocity),
                  tolerance * Largest(expected.velocity));
      }
    }
  });
}

TYPED_TEST(BatchTest, LanesDoNotDependOnTheirNeighbours) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(7);
    const Strand watched = random.UnevenStrand(5, 0.2, 9);
    const math::Pose root = random.AnyRoot();
    const State start = random.AnyState(watched, 0.5, 5, 1);
    const ClampMotion motion = random.AnyMotion(1.0 / 60);
    std::vector<State> results;
    for (int place = 0; place < 2 * kLanes; ++place) {
      Packed<T> packed;
      for (int i = 0; i < 2 * kLanes - place % 5; ++i) {
        if (i == place || (i == 0 && place >= 2 * kLanes - place % 5)) {
          packed.Add(watched, root, start);
        } else {
          const Strand other = random.UnevenStrand(5, random.Uniform(0.05, 0.4), 30);
          State state = random.AnyState(other, 0.5, 5, 1);
          if (i % 7 == 3) state.rate[2].x() = std::numeric_limits<double>::infinity();
          packed.Add(other, random.AnyRoot(), state);
        }
      }
      packed.Pack();
      for (int step = 0; step < 3; ++step) (void)packed.Step(kernels, motion, Surroundings{});
      for (int i = 0; i < packed.size(); ++i) {
        if (packed.strand(i).natural == watched.natural) {
          results.push_back(packed.Get(i));
        }
      }
    }
    ASSERT_EQ(results.size(), size_t{2 * kLanes});
    for (const State& result : results) {
      EXPECT_EQ(result.theta, results[0].theta);
      EXPECT_EQ(result.rate, results[0].rate);
      EXPECT_EQ(result.velocity, results[0].velocity);
    }
  });
}

// The largest angle of the packed strands at which the next step of `dt` evaluates its kinematics.
template <typename T>
double LargestExtrapolated(const Packed<T>& packed, double dt) {
  double largest = 0;
  for (int i = 0; i < packed.size(); ++i) {
    const State state = packed.Get(i);
    for (size_t Q = 0; Q < state.theta.size(); ++Q) {
      largest = std::max(largest, (state.theta[Q] + kTheta * dt * state.rate[Q]).norm());
    }
  }
  return largest;
}

TYPED_TEST(BatchTest, ACalmLaneDoesNotDependOnWoundNeighbours) {
  using T = TypeParam;
  // Lanes that are all bent less than this [rad] need no doublings (rod.md, B2), and skip what
  // concerns them.
  const double few = std::sqrt(2.5);
  constexpr double kDt = 1.0 / 60;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(70);
    const Strand watched = random.UnevenStrand(5, 0.2, 0.1);
    const math::Pose root = random.AnyRoot();
    const State start = random.AnyState(watched, 0.2, 1, 0.1);
    const math::Pose begin = random.Pose();
    const math::Pose end{begin.p + random.Vector(1e-3),
                         math::FromRotationVector(random.Vector(0.02)) * begin.q};
    std::vector<State> results;
    for (const double angle : {0.2, 40.0}) {
      for (int place = 0; place < kLanes; ++place) {
        SCOPED_TRACE(testing::Message() << "angle=" << angle << " place=" << place);
        Packed<T> packed;
        for (int i = 0; i < kLanes; ++i) {
          if (i == place) {
            packed.Add(watched, root, start);
          } else {  // Alike in natural shape and place: strands keep their order in the block.
            const Strand other = random.UnevenStrand(5, 0.2, 0.1);
            const math::Pose beside{root.p, random.AnyRoot().q};
            packed.Add(other, beside, random.AnyState(other, angle, 1, 0.1));
          }
        }
        packed.Pack();
        ASSERT_EQ(packed.batch().blocks()[0].strands[place], place);
        for (int step = 0; step < 3; ++step) {
          const double largest = LargestExtrapolated(packed, kDt);
          ASSERT_TRUE(angle < few ? largest < few : largest > few || step > 0) << largest;
          ASSERT_EQ(packed.Step(kernels, {begin, end, kDt}, Surroundings{}), 0u);
        }
        results.push_back(packed.Get(place));
      }
    }
    for (const State& result : results) {
      EXPECT_EQ(result.theta, results[0].theta);
      EXPECT_EQ(result.rate, results[0].rate);
      EXPECT_EQ(result.velocity, results[0].velocity);
    }
  });
}

TYPED_TEST(BatchTest, HeadsMayShareABlock) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(17);
    Packed<T> together, alone[2];
    ClampMotion motions[2] = {random.AnyMotion(1.0 / 60), random.AnyMotion(1.0 / 90)};
    Surroundings airs[2] = {random.AnyAir(), random.AnyAir()};
    constexpr int kOfFirst = 6;
    for (int i = 0; i < kLanes; ++i) {
      const Strand strand = random.UnevenStrand(5, 0.2, 2);
      const math::Pose root = random.AnyRoot();
      const State start = random.AnyState(strand, 0.5, 5, 1);
      together.Add(strand, root, start);
      alone[i >= kOfFirst].Add(strand, root, start);
    }
    together.Pack();
    // Lanes are in the order of `Block::strands`.
    std::array<Row<T>, layout::kDriveRows> drive;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int head = together.batch().blocks()[0].strands[lane] >= kOfFirst;
      SetDrive<T>(motions[head], airs[head], lane, lane + 1, drive);
    }
    ASSERT_EQ(together.StepWith(kernels, drive), 0u);
    for (int head = 0; head < 2; ++head) {
      alone[head].Pack();
      ASSERT_EQ(alone[head].Step(kernels, motions[head], airs[head]), 0u);
      for (int i = 0; i < alone[head].size(); ++i) {
        const State a = alone[head].Get(i), b = together.Get(head * kOfFirst + i);
        EXPECT_EQ(a.theta, b.theta);
        EXPECT_EQ(a.velocity, b.velocity);
      }
    }
  });
}

TYPED_TEST(BatchTest, PositionsLieOnTheCentreline) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(3);
    for (const int N : {1, 2, 5, 9}) {
      for (const int points : {2, 3, 16, 40}) {
        SCOPED_TRACE(testing::Message() << "N=" << N << " points=" << points);
        Packed<T> packed;
        for (int i = 0; i < kLanes; ++i) {
          // Half of the lanes have element ends of their own.
          Strand strand = random.UnevenStrand(N, 0.2, 4);
          if (i % 2) strand.length.assign(N, 0.2 / N);
          packed.Add(strand, random.AnyRoot(), random.AnyState(strand, 0.5, 0, 0));
        }
        packed.Pack();
        const math::Pose head = random.Pose();
        const auto positions = packed.Sample(kernels, head, points);
        const double tolerance = std::is_same_v<T, float> ? 1e-6 : 1e-14;
        for (int i = 0; i < packed.size(); ++i) {
          const Strand& strand = packed.strand(i);
          const State state = packed.Get(i);
          for (int j = 0; j < points; ++j) {
            const double s = strand.TotalLength() * j / (points - 1);
            const Vector3d expected =
                PointAt(strand, head * packed.root(i), state.theta, Locate(strand, s)).r;
            for (int k = 0; k < 3; ++k) {
              ASSERT_NEAR(positions[i][j][k], expected[k], tolerance) << i << " point " << j;
            }
          }
        }
      }
    }
  });
}

// The angles that a block holds, rebuilt in double precision, are where its own positions say, up
// to roundings of the phase: a client may take either.
TEST(BatchSampleTest, IsOffByRoundingsOfTheAngle) {
  for (const simd::Isa isa : simd::Supported()) {
    Random random(4);
    for (const double angle : {1.0, 10.0, 100.0, 1e3, 1e4}) {
      Packed<float> packed;
      for (int i = 0; i < kLanes; ++i) {
        packed.Add(random.UnevenStrand(10, 5, 0), random.AnyRoot(),
                   random.AnyState(random.UnevenStrand(10, 5, 0), angle, 0, 0));
      }
      packed.Pack();
      const auto positions = packed.Sample(KernelsFor<float>(isa), {}, 17);
      double worst = 0;
      for (int i = 0; i < kLanes; ++i) {
        const std::vector<Vector3d> theta = packed.Get(i).theta;
        for (int j = 0; j < 17; ++j) {
          const ArcPosition at = Locate(packed.strand(i), packed.strand(i).TotalLength() * j / 16);
          const Vector3d exact = PointAt(packed.strand(i), packed.root(i), theta, at).r;
          worst = std::max(worst, (positions[i][j] - exact).norm() / 5);
        }
      }
      EXPECT_LT(worst, 1e-7 * (3 + angle)) << angle;
    }
  }
}

TYPED_TEST(BatchTest, PacksFullBlocksOfEqualElementNumber) {
  using T = TypeParam;
  Random random(5);
  Packed<T> packed;
  for (int i = 0; i < 100; ++i) {
    const Strand strand = random.UnevenStrand(i % 3 + 4, 0.2, i % 2 ? 30 : 1);
    packed.Add(strand, random.AnyRoot(), random.AnyState(strand, 0.5, 5, 1));
  }
  packed.Pack();
  std::vector<int> seen(100, 0);
  for (const auto& block : packed.batch().blocks()) {
    for (int lane = 0; lane < block.count; ++lane) {
      EXPECT_EQ(packed.strand(block.strands[lane]).elements(), block.elements);
      ++seen[block.strands[lane]];
    }
  }
  EXPECT_EQ(seen, std::vector<int>(100, 1));
  EXPECT_EQ(packed.batch().blocks().size(), 9u);  // 34, 33 and 33 strands.
  const double tolerance = std::is_same_v<T, float> ? 1e-5 : 1e-13;
  for (int i = 0; i < 100; ++i) {
    EXPECT_LT(Difference(packed.Get(i).theta, packed.start(i).theta), tolerance);
    EXPECT_LT(Difference(packed.Get(i).rate, packed.start(i).rate), tolerance);
    EXPECT_LT(Difference(packed.Get(i).velocity, packed.start(i).velocity), tolerance);
  }
}

// Strands of eight places far from each other, given in turn: a block holds those of one place.
TYPED_TEST(BatchTest, StrandsThatGrowNearEachOtherShareABlock) {
  using T = TypeParam;
  Random random(74);
  const Strand strand = random.UnevenStrand(3, 0.2, 0.1);
  Packed<T> packed;
  for (int i = 0; i < 8 * kLanes; ++i) {
    math::Pose root = random.AnyRoot();
    root.p = Vector3d(i & 1, i >> 1 & 1, i >> 2 & 1) + random.Vector(0.1);
    packed.Add(strand, root, random.AnyState(strand, 0.2, 1, 0.1));
  }
  packed.Pack();
  ASSERT_EQ(packed.batch().blocks().size(), 8u);
  for (const auto& block : packed.batch().blocks()) {
    for (const int i : block.strands) EXPECT_EQ(i % 8, block.strands[0] % 8);
  }
}

TYPED_TEST(BatchTest, TurningVelocitiesTurnsThemAll) {
  using T = TypeParam;
  Random random(6);
  Packed<T> packed = AnyPacked<T>(random, 20, 3, 1);
  const Eigen::Matrix3d turn = random.Rotation().toRotationMatrix();
  packed.batch().RotateVelocities(turn, packed.state());
  for (int i = 0; i < 20; ++i) {
    State expected = packed.start(i);
    for (Vector3d& u : expected.velocity) u = turn * u;
    EXPECT_LT(Difference(packed.Get(i).velocity, expected.velocity), 1e-6);
    EXPECT_LT(Difference(packed.Get(i).theta, expected.theta), 1e-6);
  }
}

TYPED_TEST(BatchTest, ReportsTheLanesThatFail) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(8);
    Packed<T> packed;
    for (int i = 0; i < kLanes; ++i) {
      const Strand strand = random.UnevenStrand(3, 0.2, 1);
      State state = random.AnyState(strand, 0.5, 5, 1);
      if (i == 4) state.theta[1].y() = std::numeric_limits<double>::quiet_NaN();
      if (i == 11) state.velocity[2].x() = std::numeric_limits<double>::infinity();
      packed.Add(strand, random.AnyRoot(), state);
    }
    packed.Pack();
    uint32_t expected = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
      const int strand = packed.batch().blocks()[0].strands[lane];
      if (strand == 4 || strand == 11) expected |= 1u << lane;
    }
    EXPECT_EQ(packed.Step(kernels, random.AnyMotion(0.01), Surroundings{}), expected);
  });
}

TYPED_TEST(BatchTest, AWarmStepDoesNotAllocate) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(9);
    Packed<T> packed = AnyPacked<T>(random, 40, 5, 3);
    const ClampMotion motion = random.AnyMotion(0.01);
    (void)packed.Step(kernels, motion, Surroundings{});
    const mane::fixtures::AllocationCount allocations;
    (void)packed.Step(kernels, motion, Surroundings{});
    EXPECT_EQ(allocations.count(), 0);
  });
}

}  // namespace
}  // namespace mane::rod
