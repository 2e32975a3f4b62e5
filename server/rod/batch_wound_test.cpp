// Properties of the batched step of wound strands, for float and double and every instruction set:
//   oracle        equals Step of wound.h, strand by strand, for any N, coils, clamps, airs
//   independence  a lane's bits depend on nothing in other lanes
//   positions     are those of the hair laid around its axis
//   bounded       no motion, step, damping or coil makes a number non-finite or a hair longer
//   rest          hair at rest on a head that does not move stays there
//   precision     float32 follows double over two seconds of shaking

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <type_traits>
#include <vector>

#include "rod/test_batches.h"
#include "rod/test_motions.h"
#include "rod/test_wound.h"
#include "rod/wound.h"
#include "rod/wound_shape.h"
#include "rod/wound_statics.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Random;
using fixtures::WoundOwned;
using layout::kLanes;

template <typename T>
using PackedWound = fixtures::Packed<T, WoundStrand, WoundOwned>;

template <typename T>
class BatchWoundTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(BatchWoundTest, fixtures::Numbers);

template <typename Vector>
double Largest(const std::vector<Vector>& values) {
  double largest = 0;
  for (const Vector& v : values) largest = std::max(largest, v.norm());
  return largest;
}

template <typename Vector>
double Difference(const std::vector<Vector>& a, const std::vector<Vector>& b) {
  double largest = 0;
  for (size_t i = 0; i < a.size(); ++i) largest = std::max(largest, (a[i] - b[i]).norm());
  return largest;
}

TYPED_TEST(BatchWoundTest, EqualsTheStepOfEachStrand) {
  using T = TypeParam;
  // As for plain strands: conditioning multiplies the rounding.
  const double tolerance = std::is_same_v<T, float> ? 3e-3 : 1e-9;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(811);
    for (const int N : {1, 2, 3, 5, 10, 16}) {
      for (const double dt : {1.0 / 120, 1.0 / 60, 0.1}) {
        SCOPED_TRACE(testing::Message() << "N=" << N << " dt=" << dt);
        PackedWound<T> packed;
        for (int i = 0; i < 19; ++i) {
          const WoundStrand wound = AnyWound(random, N, 0.2, random.Uniform(3, 12) * N);
          packed.Add(wound, random.AnyRoot(), WoundOwned(wound, random, 0.5, 5, 1));
        }
        packed.Pack();
        const ClampMotion motion = random.AnyMotion(dt);
        const Surroundings air = random.AnyAir();
        ASSERT_EQ(packed.Step(kernels, motion, air), 0u);
        WoundScratch scratch;
        for (int i = 0; i < packed.size(); ++i) {
          SCOPED_TRACE(testing::Message() << "strand " << i);
          WoundOwned expected = packed.start(i);
          const WoundOwned result = packed.Get(i);
          const math::Pose& root = packed.root(i);
          const ClampMotion clamp{motion.begin * root, motion.end * root, dt};
          ASSERT_TRUE(Step(packed.strand(i), clamp, air, expected.View(), scratch));
          const double rates = Largest(expected.rate), speeds = Largest(expected.velocity);
          EXPECT_LT(Difference(result.rate, expected.rate), tolerance * rates);
          EXPECT_LT(Difference(result.x, expected.x), tolerance * dt * rates + 1e-6);
          EXPECT_LT(Difference(result.velocity, expected.velocity), tolerance * speeds);
        }
      }
    }
  });
}

TYPED_TEST(BatchWoundTest, LanesDoNotDependOnTheirNeighbours) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(7);
    const WoundStrand watched = AnyWound(random, 5, 0.2, 30);
    const math::Pose root = random.AnyRoot();
    // Once bent little, once much, among neighbours of the other kind.
    for (const double angle : {0.1, 8.0}) {
      const WoundOwned start(watched, random, angle, 5, 1);
      const ClampMotion motion = random.AnyMotion(1.0 / 60);
      std::vector<WoundOwned> results;
      for (int place = 0; place < kLanes; ++place) {
        PackedWound<T> packed;
        for (int i = 0; i < kLanes; ++i) {
          if (i == place) {
            packed.Add(watched, root, start);
            continue;
          }
          const WoundStrand other = AnyWound(random, 5, random.Uniform(0.05, 0.4), 40);
          packed.Add(other, random.AnyRoot(), WoundOwned(other, random, 8.1 - angle, 5, 1));
        }
        packed.Pack();
        (void)packed.Step(kernels, motion, Surroundings{});
        results.push_back(packed.Get(place));
      }
      for (const WoundOwned& result : results) {
        EXPECT_EQ(result.x, results[0].x);
        EXPECT_EQ(result.rate, results[0].rate);
        EXPECT_EQ(result.velocity, results[0].velocity);
      }
    }
  });
}

TYPED_TEST(BatchWoundTest, PositionsAreThoseOfTheHair) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(3);
    for (const int N : {1, 2, 5, 9}) {
      for (const int points : {2, 3, 16, 40}) {
        SCOPED_TRACE(testing::Message() << "N=" << N << " points=" << points);
        PackedWound<T> packed;
        for (int i = 0; i < kLanes; ++i) {
          const WoundStrand wound = AnyWound(random, N, 0.2, random.Uniform(1, 12) * N);
          // From natural to bent as fast as the coil turns and more.
          packed.Add(wound, random.AnyRoot(), WoundOwned(wound, random, i * i * 0.2, 0, 0));
        }
        packed.Pack();
        const math::Pose head = random.Pose();
        const auto positions = packed.Sample(kernels, head, points);
        // Angles of 100 rad carry that many roundings.
        const double tolerance = std::is_same_v<T, float> ? 1e-5 : 1e-13;
        for (int i = 0; i < packed.size(); ++i) {
          const WoundStrand& wound = packed.strand(i);
          const WoundOwned state = packed.Get(i);
          const auto frames = WoundFrames(wound, head * packed.root(i), state.x);
          const double L = wound.strand.TotalLength();
          for (int j = 0; j < points; ++j) {
            const Vector3d expected = PointOnHair(wound, frames, state.x, L * j / (points - 1));
            ASSERT_LT((positions[i][j] - expected).norm(), tolerance) << i << " point " << j;
          }
        }
      }
    }
  });
}

TYPED_TEST(BatchWoundTest, IsBoundedUnderHostileMotion) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(2025);
    PackedWound<T> packed;
    for (int i = 0; i < 768; ++i) {
      const int N = 1 + i % 12;
      WoundStrand wound =
          AnyWound(random, N, random.Uniform(0.02, 0.5), random.Uniform(0.5, 20) * N);
      if (i % 3 == 0) wound.strand.internal_friction = 0;
      if (i % 5 == 0) wound.strand.air_drag = 0;
      packed.Add(wound, random.AnyRoot(), WoundOwned(wound));
    }
    packed.Pack();
    math::Pose pose;
    for (int i = 0; i < 120; ++i) {
      const double dt = i % 7 == 0 ? 0.1 : random.Uniform(1.0 / 240, 1.0 / 30);
      const math::Pose next = Hostile(random, pose, i);
      Surroundings air;
      air.gravity = random.Vector(20);
      air.wind = i % 11 == 0 ? random.Vector(50) : Vector3d::Zero();
      air.air_drag_scale = i % 2;
      ASSERT_EQ(packed.Step(kernels, {pose, next, dt}, air), 0u) << "step " << i;
      pose = next;
      if (i % 10 != 9) continue;
      const int points = 33;
      const auto positions = packed.Sample(kernels, {}, points);
      for (int s = 0; s < packed.size(); ++s) {
        const double spacing = packed.strand(s).strand.TotalLength() / (points - 1);
        for (int j = 1; j < points; ++j) {
          ASSERT_LE((positions[s][j] - positions[s][j - 1]).norm(), spacing * (1 + 1e-3) + 1e-6)
              << s;
        }
      }
    }
  });
}

// A wound strand of Appendix B that leaves the head in any direction but down, its curl varied.
WoundStrand Presets(Random& random, int i, double length) {
  const fixtures::Hair& hair = fixtures::AppendixB()[2 + i % 2];
  const int N = i % 4 < 2 ? 5 : 10;
  const Strand strand = fixtures::Graded(MakeStrand(hair, length, N), N == 5 ? 1.4 : 1.15);
  return MakeWound(Varied(strand, 0.05, random));
}

TYPED_TEST(BatchWoundTest, HairAtRestStaysAtRest) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const double dt : {1.0 / 60, 1.0 / 240}) {
      for (const double friction : {0.0, 1.0}) {
        for (const double length : {0.2, 0.5}) {
          SCOPED_TRACE(testing::Message()
                       << "dt=" << dt << " friction=" << friction << " L=" << length);
          Random random(3);
          PackedWound<T> packed;
          for (int i = 0; i < 32; ++i) {
            WoundStrand wound = Presets(random, i, length);
            wound.strand.internal_friction *= friction;
            Vector3d out = random.Direction();
            out.y() = 0.7 * std::abs(out.y());
            const math::Pose root{random.Vector(0.1), Eigen::Quaterniond::FromTwoVectors(
                                                          Vector3d::UnitX(), out.normalized())};
            WoundOwned state(wound);
            ASSERT_TRUE(SolveRestShape(wound, root, {0, -9.81, 0}, state.x).converged);
            packed.Add(wound, root, state);
          }
          packed.Pack();
          const auto before = packed.Sample(kernels, {}, 2);
          for (int i = 0; i * dt < 4; ++i) ASSERT_EQ(packed.Step(kernels, {{}, {}, dt}, {}), 0u);
          const auto after = packed.Sample(kernels, {}, 2);
          for (int i = 0; i < packed.size(); ++i) {
            EXPECT_LT((after[i][1] - before[i][1]).norm(), 1e-4 * length) << i;
          }
        }
      }
    }
  });
}

TEST(BatchWoundPrecisionTest, FloatFollowsDouble) {
  for (const simd::Isa isa : simd::Supported()) {
    SCOPED_TRACE(std::string(simd::Name(isa)));
    PackedWound<float> floats;
    PackedWound<double> doubles;
    Random random(1);
    const double length = 0.2;
    for (int i = 0; i < 32; ++i) {
      const WoundStrand wound = Presets(random, i, length);
      const math::Pose root{random.Vector(0.1),
                            Eigen::Quaterniond::FromTwoVectors(
                                Vector3d::UnitX(), Vector3d(std::cos(i), -0.5, std::sin(i)))};
      floats.Add(wound, root, WoundOwned(wound));
      doubles.Add(wound, root, WoundOwned(wound));
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
      const auto near = floats.Sample(KernelsFor<float>(isa), motion.end, 2);
      const auto exact = doubles.Sample(KernelsFor<double>(isa), motion.end, 2);
      for (size_t s = 0; s < near.size(); ++s, ++count)
        sum += (near[s][1] - exact[s][1]).squaredNorm();
    }
    EXPECT_LT(std::sqrt(sum / count), 1e-5 * length);
  }
}

}  // namespace
}  // namespace mane::rod
