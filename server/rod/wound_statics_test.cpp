// Properties of the static equilibrium of a wound strand:
//   minimum  no small change of the unknowns lowers the energy
//   rest     is where a moving strand comes to rest

#include "rod/wound_statics.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rod/test_wound.h"
#include "rod/wound_shape.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Random;
using fixtures::WoundOwned;

const Vector3d kGravity(0, -9.81, 0);

double Potential(const WoundStrand& wound, const math::Pose& clamp,
                 const std::vector<Vector4d>& x) {
  return ElasticEnergy(wound, x) + GravityPotential(wound, clamp, kGravity, x);
}

TEST(WoundStaticsTest, NoSmallChangeLowersTheEnergy) {
  Random random(4);
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    const fixtures::Hair& hair = fixtures::AppendixB()[2 + i % 2];
    const WoundStrand wound = fixtures::MakeGraded(hair, 0.1 * (1 + i / 2 % 3), i % 4 < 2 ? 10 : 5);
    const math::Pose clamp = random.Pose();
    std::vector<Vector4d> x = wound.natural;
    const StaticsReport report = SolveRestShape(wound, clamp, kGravity, x);
    EXPECT_TRUE(report.converged) << report.residual;
    EXPECT_LE(report.iterations, 60);
    const double rest = Potential(wound, clamp, x);
    for (int k = 0; k < 100; ++k) {
      std::vector<Vector4d> other = x;
      for (Vector4d& v : other) v += 0.01 * Vector4d(random.Vector(1).homogeneous());
      EXPECT_GT(Potential(wound, clamp, other), rest);
    }
  }
}

TEST(WoundStaticsTest, MovingHairComesToRestThere) {
  for (const int hair : {2, 3}) {
    const WoundStrand wound = fixtures::MakeGraded(fixtures::AppendixB()[hair], 0.2, 10);
    const math::Pose clamp = fixtures::AxisClamp(wound.strand, false);
    std::vector<Vector4d> rest = wound.natural;
    ASSERT_TRUE(SolveRestShape(wound, clamp, kGravity, rest).converged);
    // At rest it stays, bit for bit but for rounding; nearby it returns.
    for (const double off : {0.0, 0.2}) {
      WoundOwned state(wound);
      for (int Q = 0; Q < 10; ++Q) state.x[Q] = rest[Q] * (1 + off);
      WoundScratch scratch;
      Surroundings air;
      air.air_drag_scale = 10;
      const int steps = off > 0 ? 3000 : 100;
      for (int i = 0; i < steps; ++i) {
        ASSERT_TRUE(Step(wound, {clamp, clamp, 1.0 / 60}, air, state.View(), scratch));
      }
      for (int Q = 0; Q < 10; ++Q) EXPECT_LT((state.x[Q] - rest[Q]).norm(), 1e-6) << off;
    }
  }
}

}  // namespace
}  // namespace mane::rod
