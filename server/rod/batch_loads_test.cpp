// Properties of the batched steps among loads, for float and double and every instruction set:
//   oracle       a plain strand's step equals Step with the same loads
//   no loads     the step without, to rounding
//   points       lie on the centreline at the extrapolated shape; their velocities are its change
//   straight     points end where the step's velocities lead but for what it says of that
//   reciprocity  a push at a moves b along a direction as much as one at b along that moves a
//   digits       what holds points by far leaves float32 the soft directions
//   stop         what presses hard keeps its point at the surface's speed, and nothing bounces off
//   neighbours   a lane's bits do not depend on loads on others

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <type_traits>
#include <vector>

#include "rod/chain.h"
#include "rod/test_batches.h"
#include "rod/test_loads.h"
#include "rod/test_wound.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Difference;
using fixtures::FirstPoints;
using fixtures::Largest;
using fixtures::Load;
using fixtures::Packed;
using fixtures::PointCount;
using fixtures::Random;
using fixtures::Solver;
using fixtures::State;
using fixtures::Where;
using fixtures::WoundOwned;
using layout::kLanes;

double UnitOf(const Strand& strand) {
  return strand.linear_density * strand.TotalLength() / strand.elements();
}

template <typename T>
class BatchLoadsTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(BatchLoadsTest, fixtures::Numbers);

template <typename T>
Packed<T> PlainStrands(Random& random, int N, double angle) {
  Packed<T> packed;
  for (int i = 0; i < kLanes; ++i) {
    const Strand strand = random.UnevenStrand(N, 0.2, angle);
    packed.Add(strand, random.AnyRoot(), random.AnyState(strand, 0.5, 5, 1));
  }
  packed.Pack();
  return packed;
}

template <typename T>
Packed<T, WoundStrand, WoundOwned> WoundStrands(Random& random, int N) {
  Packed<T, WoundStrand, WoundOwned> packed;
  for (int i = 0; i < kLanes; ++i) {
    const WoundStrand wound = AnyWound(random, N, 0.2, random.Uniform(3, 9) * N);
    packed.Add(wound, random.AnyRoot(), WoundOwned(wound, random, 0.3, 5, 1));
  }
  packed.Pack();
  return packed;
}

TYPED_TEST(BatchLoadsTest, EqualsTheStepAmongTheSameLoads) {
  using T = TypeParam;
  const double tolerance = std::is_same_v<T, float> ? 3e-3 : 1e-9;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(17);
    for (const int N : {1, 2, 5, 10}) {
      SCOPED_TRACE(testing::Message() << "N=" << N);
      Packed<T> packed = PlainStrands<T>(random, N, 2.5);
      const ClampMotion motion = random.AnyMotion(1.0 / 60);
      const Surroundings air = random.AnyAir();
      Solver<T> solver(kernels, packed.batch(), motion, air);
      solver.Approach(packed.state());
      std::vector<std::vector<PointLoad>> expected_loads(kLanes);
      const auto& lanes = packed.batch().blocks()[0].strands;
      for (int point = 0; point < PointCount(N); ++point) {
        if (point % 4 == 2) continue;  // Some points have no load,
        for (int lane = 0; lane < kLanes; ++lane) {
          if ((point + lane) % 3 == 0) continue;  // nor have some lanes of others.
          const double unit = UnitOf(packed.strand(lanes[lane]));
          Load load{random.Direction(), unit * random.Uniform(0, 30), unit * random.Uniform(0, 30),
                    random.Vector(unit), random.Uniform(-0.1, 0.1)};
          solver.SetLoad(point, lane, load, unit);
          const Eigen::Matrix3d along = load.normal * load.normal.transpose();
          expected_loads[lane].push_back(
              {Where(point).element, Where(point).fraction,
               load.hold * (Eigen::Matrix3d::Identity() - along) + load.press * along, load.push,
               load.normal, load.surface_speed});
        }
      }
      std::vector<Row<T>> next(packed.state().size());
      solver.Solve(packed.state(), next);
      StepScratch scratch;
      for (int lane = 0; lane < kLanes; ++lane) {
        const int i = lanes[lane];
        State expected = packed.start(i), result = packed.start(i);
        packed.batch().GetStrand(i, next, result.View());
        const math::Pose& root = packed.root(i);
        ASSERT_TRUE(Step(packed.strand(i), {motion.begin * root, motion.end * root, motion.dt}, air,
                         expected_loads[lane], expected.View(), scratch));
        EXPECT_LT(Difference(result.rate, expected.rate), tolerance * Largest(expected.rate));
        EXPECT_LT(Difference(result.velocity, expected.velocity),
                  tolerance * Largest(expected.velocity));
      }
    }
  });
}

// Soft hair that hangs straight from a bent root, in any direction, and is held at its tip and near
// its root by far more than its own mass: what turns about the line between them is left with its
// own stiffness, 1e-6 of the rest. Rounding may turn it a little, but not throw it.
TEST(BatchLoadsDigitsTest, HoldsLeaveSoftDirectionsTheirDigits) {
  Random random(23);
  for (int trial = 0; trial < 100; ++trial) {
    std::vector<std::unique_ptr<Strand>> strands;
    std::vector<RootedStrand> rooted;
    std::vector<State> starts;
    for (int lane = 0; lane < kLanes; ++lane) {
      Strand strand = fixtures::MakeStrand(fixtures::AppendixB()[0], 0.45, 6);
      strand.length = {0.0041, 0.0067, 0.018, 0.1213, 0.15, 0.15};
      strand.natural.assign(6, Vector3d::Zero());
      State state(strand);
      const Vector3d bend = random.Uniform(0.3, 0.7) * Vector3d(0, -0.38, 0.92);
      for (int Q = 0; Q < 4; ++Q) state.theta[Q] = (Q < 3 ? 1 : 0.4) * bend;
      for (int Q = 4; Q < 6; ++Q) state.theta[Q] = 0.01 * random.Direction();
      math::Pose root = random.AnyRoot();
      if (lane % 2 == 0) {  // It hangs.
        const auto at = [&](int Q) { return PointAt(strand, root, state.theta, {Q, 0.5}).r; };
        root.q = Eigen::Quaterniond::FromTwoVectors(at(5) - at(4), -Vector3d::UnitY()) * root.q;
      }
      strands.push_back(std::make_unique<Strand>(strand));
      rooted.push_back({strands.back().get(), root});
      starts.push_back(state);
    }
    std::vector<Load> loads;
    for (int i = 0; i < 2 * kLanes; ++i) {
      const double unit = UnitOf(*strands[0]);
      loads.push_back({random.Direction(), 200 * unit, 3200 * unit});
    }
    const auto rates = [&]<typename T>(const KernelTable<T>& kernels) {
      const Batch<T> batch(rooted);
      std::vector<Row<T>> state(batch.state_rows()), next(batch.state_rows());
      for (int i = 0; i < kLanes; ++i) batch.SetStrand(i, starts[i].View(), state);
      Solver<T> solver(kernels, batch, {{}, {}, 1.0 / 120}, {});
      solver.Approach(state);
      for (int lane = 0; lane < kLanes; ++lane) {
        const int i = batch.blocks()[0].strands[lane];
        solver.SetLoad(5, lane, loads[2 * i], UnitOf(*strands[i]));
        solver.SetLoad(PointCount(6) - 1, lane, loads[2 * i + 1], UnitOf(*strands[i]));
      }
      solver.Solve(state, next);
      std::vector<Vector3d> result;
      for (int i = 0; i < kLanes; ++i) {
        State end = starts[i];
        batch.GetStrand(i, next, end.View());
        result.insert(result.end(), end.rate.begin(), end.rate.end());
      }
      return result;
    };
    const std::vector<Vector3d> exact = rates(KernelsFor<double>(simd::Isa::kScalar));
    for (const simd::Isa isa : simd::Supported()) {
      const std::vector<Vector3d> rounded = rates(KernelsFor<float>(isa));
      EXPECT_LT(Difference(rounded, exact), 3 * Largest(exact)) << simd::Name(isa);
    }
  }
}

// What the tests below ask of both kinds.
template <typename T, typename Pack>
void ExpectTheSameWithoutLoads(const KernelTable<T>& kernels, Pack packed) {
  const ClampMotion motion = Random(3).AnyMotion(1.0 / 60);
  Solver<T> solver(kernels, packed.batch(), motion, {});
  solver.Approach(packed.state());
  std::vector<Row<T>> next(packed.state().size());
  solver.Solve(packed.state(), next);
  ASSERT_EQ(packed.Step(kernels, motion, {}), 0U);
  double largest = 0, difference = 0;
  for (size_t row = 0; row < next.size(); ++row) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const double value = packed.state()[row].lane[lane];
      largest = std::max(largest, std::abs(value));
      difference = std::max(difference, std::abs(next[row].lane[lane] - value));
    }
  }
  EXPECT_LT(difference, (std::is_same_v<T, float> ? 1e-3 : 1e-10) * largest);
}

TYPED_TEST(BatchLoadsTest, IsTheStepWhereThereAreNone) {
  this->ForEveryIsa([&](const KernelTable<TypeParam>& kernels) {
    Random random(5);
    ExpectTheSameWithoutLoads(kernels, PlainStrands<TypeParam>(random, 6, 2));
    ExpectTheSameWithoutLoads(kernels, WoundStrands<TypeParam>(random, 6));
  });
}

// Positions a moment later less those now are the velocities that `approach` says: of a strand that
// moves with its rates alone, on a clamp that moves.
template <typename T, typename Pack>
void ExpectVelocitiesToBeTheChangeOfPositions(const KernelTable<T>& kernels, Pack packed) {
  if constexpr (std::is_same_v<T, double>) {
    const double dt = 1e-5;
    // Slow turns: roots move along chords.
    Random random(8);
    const math::Pose begin = random.Pose();
    const math::Pose end{begin.p + random.Vector(0.01),
                         math::FromRotationVector(random.Vector(0.01)) * begin.q};
    const ClampMotion motion{begin, end, 1.0 / 60};
    const auto at = [&](double time) {
      return math::Interpolate(motion.begin, motion.end, time / motion.dt);
    };
    // Both linearise kTheta dt on: at one time of the head, of angles that `dt` parts.
    const double dt0 = 1.0 / 60;
    Solver<T> now(kernels, packed.batch(), {at(0), at(dt0), dt0}, {});
    Solver<T> later(kernels, packed.batch(), {at(0), at(dt0 + dt), dt0 + dt}, {});
    now.Approach(packed.state());
    later.Approach(packed.state());
    const double between = kTheta * dt;
    const Vector3d head_moves = (at(kTheta * (dt0 + dt)).p - at(kTheta * dt0).p);
    for (int point = 0; point < PointCount(packed.batch().blocks()[0].elements); ++point) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const Vector3d change = later.Point(point, lane, layout::kPosition) -
                                now.Point(point, lane, layout::kPosition) + head_moves;
        const Vector3d mean = 0.5 * (later.Point(point, lane, layout::kLastVelocity) +
                                     now.Point(point, lane, layout::kLastVelocity));
        EXPECT_LT((change / between - mean).norm(), 2e-3 * (0.1 + mean.norm()))
            << "point " << point << " lane " << lane;
      }
    }
  }
}

TYPED_TEST(BatchLoadsTest, VelocitiesOfPointsAreTheChangeOfTheirPositions) {
  this->ForEveryIsa([&](const KernelTable<TypeParam>& kernels) {
    Random random(6);
    ExpectVelocitiesToBeTheChangeOfPositions(kernels, PlainStrands<TypeParam>(random, 4, 2));
    ExpectVelocitiesToBeTheChangeOfPositions(kernels, WoundStrands<TypeParam>(random, 4));
  });
}

// Strands that swing wildly, and other than they did. What an element does by its own bend, which
// is not counted, is as much as the rest at most.
template <typename T, typename Pack>
void ExpectStraightLinesButForTurning(const KernelTable<T>& kernels, Pack packed) {
  if constexpr (std::is_same_v<T, double>) {
    const double dt = 1e-3;
    const math::Pose head = Random(11).Pose();
    Solver<T> solver(kernels, packed.batch(), {head, head, dt}, {});
    solver.Approach(packed.state());
    std::vector<Row<T>> next(packed.state().size());
    solver.Solve(packed.state(), next);
    Solver<T> end(kernels, packed.batch(), {head, head, 1e-12}, {});
    end.Approach(next);
    for (int lane = 0; lane < kLanes; ++lane) {
      double farthest = 0;
      for (int point = 0; point < PointCount(packed.batch().blocks()[0].elements); ++point) {
        if (Where(point).fraction < 1) continue;
        const Vector3d leads = dt * (solver.Velocity(point, lane) -
                                     kTheta * solver.Point(point, lane, layout::kLastVelocity));
        const Vector3d went = end.Point(point, lane, layout::kPosition) -
                              solver.Point(point, lane, layout::kPosition);
        farthest = std::max(farthest, (went - leads).norm());
      }
      EXPECT_GT(farthest, 1e-6);
      const double said = 0.5 * dt * dt * solver.Turning(lane);
      EXPECT_GT(said, 0.6 * farthest) << "lane " << lane;
      EXPECT_LT(said, 2 * farthest) << "lane " << lane;
    }
  }
}

TYPED_TEST(BatchLoadsTest, StepsLeaveStraightLinesByWhatTheySay) {
  this->ForEveryIsa([&](const KernelTable<TypeParam>& kernels) {
    Random random(23);
    ExpectStraightLinesButForTurning(kernels, PlainStrands<TypeParam>(random, 6, 0.5));
    ExpectStraightLinesButForTurning(kernels, WoundStrands<TypeParam>(random, 6));
  });
}

TYPED_TEST(BatchLoadsTest, PointsLieOnTheExtrapolatedCentreline) {
  using T = TypeParam;
  const double tolerance = std::is_same_v<T, float> ? 2e-6 : 1e-12;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(31);
    const Packed<T> packed = PlainStrands<T>(random, 5, 4);
    const ClampMotion motion = random.AnyMotion(1.0 / 60);
    Solver<T> solver(kernels, packed.batch(), motion, {});
    solver.Approach(const_cast<Packed<T>&>(packed).state());
    const math::Pose head = math::Interpolate(motion.begin, motion.end, kTheta);
    for (int lane = 0; lane < kLanes; ++lane) {
      const int i = packed.batch().blocks()[0].strands[lane];
      State state = packed.start(i);
      for (int Q = 0; Q < 5; ++Q) state.theta[Q] += kTheta * motion.dt * state.rate[Q];
      for (int point = 0; point < PointCount(5); ++point) {
        const ArcPosition where = Where(point);
        const Vector3d r =
            PointAt(packed.strand(i), head * packed.root(i), state.theta, where).r - head.p;
        EXPECT_LT((solver.Point(point, lane, layout::kPosition) - r).norm(), tolerance);
        EXPECT_NEAR(solver.Point(point, lane, layout::kTangent).norm(), 1, 30 * tolerance);
      }
    }
  });
}

template <typename T, typename Pack>
void ExpectReciprocity(const KernelTable<T>& kernels, Pack packed) {
  const double tolerance = std::is_same_v<T, float> ? 2e-2 : 1e-7;
  Random random(12);
  const ClampMotion motion = random.AnyMotion(1.0 / 60);
  const int points = PointCount(packed.batch().blocks()[0].elements);
  std::vector<Row<T>> next(packed.state().size());
  const auto velocities = [&](int at, const Vector3d& push) {
    Solver<T> solver(kernels, packed.batch(), motion, {});
    solver.Approach(packed.state());
    for (int lane = 0; lane < kLanes; ++lane) {
      // An equal load on another point: the response is that of a strand in contact.
      solver.SetLoad(points / 2, lane, {Vector3d::UnitZ(), 5, 2}, 1);
      solver.SetLoad(at, lane, {Vector3d::UnitX(), 0, 0, push}, 1);
    }
    solver.Solve(packed.state(), next);
    return solver;
  };
  const Vector3d f = random.Direction(), g = random.Direction();
  const int a = 2, b = points - 2;
  const Solver<T> at_a = velocities(a, 10 * f), at_b = velocities(b, 10 * g),
                  none = velocities(a, Vector3d::Zero());
  for (int lane = 0; lane < kLanes; ++lane) {
    const double there = g.dot(at_a.Velocity(b, lane) - none.Velocity(b, lane));
    const double back = f.dot(at_b.Velocity(a, lane) - none.Velocity(a, lane));
    const double own = f.dot(at_a.Velocity(a, lane) - none.Velocity(a, lane));
    EXPECT_GT(own, 0);
    EXPECT_NEAR(there, back, tolerance * (std::abs(there) + own));
  }
}

TYPED_TEST(BatchLoadsTest, PushesAreReciprocal) {
  this->ForEveryIsa([&](const KernelTable<TypeParam>& kernels) {
    Random random(44);
    ExpectReciprocity(kernels, PlainStrands<TypeParam>(random, 5, 2));
    ExpectReciprocity(kernels, WoundStrands<TypeParam>(random, 5));
  });
}

template <typename T, typename Pack>
void ExpectToBeStopped(const KernelTable<T>& kernels, Pack packed) {
  const ClampMotion motion{{}, {}, 1.0 / 60};
  Solver<T> solver(kernels, packed.batch(), motion, {});
  solver.Approach(packed.state());
  const int point = PointCount(packed.batch().blocks()[0].elements) - 1;
  std::vector<Vector3d> normals;
  for (int lane = 0; lane < kLanes; ++lane) {
    normals.push_back(-solver.Point(point, lane, layout::kLastVelocity).normalized());
    solver.SetLoad(point, lane, {normals[lane], 1e3, 0, Vector3d::Zero(), 0}, 1);
  }
  std::vector<Row<T>> next(packed.state().size());
  solver.Solve(packed.state(), next);
  for (int lane = 0; lane < kLanes; ++lane) {
    EXPECT_NEAR(normals[lane].dot(solver.Velocity(point, lane)), 0, 0.02);
    auto state = packed.start(0);
    const int i = packed.batch().blocks()[0].strands[lane];
    packed.batch().GetStrand(i, next, state.View());
    const int count = static_cast<int>(state.velocity.size()) / packed.batch().blocks()[0].elements;
    for (int g = 0; g < count; ++g) {
      const Vector3d& u = state.velocity[state.velocity.size() - 1 - g];
      EXPECT_LT(normals[lane].dot(u), 1e-5);
    }
  }
}

TYPED_TEST(BatchLoadsTest, WhatIsPressedStopsAndDoesNotBounce) {
  this->ForEveryIsa([&](const KernelTable<TypeParam>& kernels) {
    Random random(91);
    ExpectToBeStopped(kernels, PlainStrands<TypeParam>(random, 5, 1));
    ExpectToBeStopped(kernels, WoundStrands<TypeParam>(random, 5));
  });
}

template <typename T, typename Pack>
void ExpectLanesAlone(const KernelTable<T>& kernels, Pack packed) {
  const ClampMotion motion = Random(3).AnyMotion(1.0 / 60);
  const auto solve = [&](bool others) {
    Solver<T> solver(kernels, packed.batch(), motion, {});
    solver.Approach(packed.state());
    Random random(1);
    for (int point = 0; point < PointCount(packed.batch().blocks()[0].elements); ++point) {
      for (int lane = 0; lane < kLanes; ++lane) {
        const Load load{random.Direction(), random.Uniform(0, 100), random.Uniform(0, 100),
                        random.Vector(1)};
        if (lane == 5 ? point == 4 : others) solver.SetLoad(point, lane, load, 1);
      }
    }
    std::vector<Row<T>> next(packed.state().size());
    solver.Solve(packed.state(), next);
    return next;
  };
  const auto alone = solve(false), among = solve(true);
  for (size_t row = 0; row < alone.size(); ++row) {
    ASSERT_EQ(alone[row].lane[5], among[row].lane[5]);
  }
}

TYPED_TEST(BatchLoadsTest, LanesDoNotDependOnLoadsOnTheirNeighbours) {
  this->ForEveryIsa([&](const KernelTable<TypeParam>& kernels) {
    Random random(77);
    ExpectLanesAlone(kernels, PlainStrands<TypeParam>(random, 5, 1));
    ExpectLanesAlone(kernels, WoundStrands<TypeParam>(random, 5));
  });
}

}  // namespace
}  // namespace mane::rod
