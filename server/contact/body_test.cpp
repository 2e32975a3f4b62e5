// Bodies that move:
//   velocity   is the derivative of the way of a material point
//   rigid      distances and normals turn along with the body
//   union      the deepest or nearest body answers, with its velocity
//   batch      float32 follows the scalar query; no allocation

#include "contact/body.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "base/test_allocations.h"
#include "contact/test_meshes.h"

namespace mane::contact {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

class BodyTest : public ::testing::Test {
 protected:
  Vector3d Vector(double reach) { return reach * Vector3d(sym_(rng_), sym_(rng_), sym_(rng_)); }
  BodyMotion Motion(double reach) {
    BodyMotion motion;
    motion.begin = {Vector(reach), math::FromRotationVector(Vector(3))};
    motion.end = {motion.begin.p + Vector(0.1),
                  motion.begin.q * math::FromRotationVector(Vector(0.5))};
    motion.duration = 1 / 60.;
    return motion;
  }
  // Bodies of every kind, each moving.
  std::vector<Body> Bodies() {
    exec::WorkerPool pool(2);
    auto field = MeshField::Build(fixtures::Sphere(3, 0.1), {}, &pool);
    EXPECT_TRUE(field);
    return {{Ellipsoid({0.1, 0.2, 0.15}), Motion(0.3)},
            {Capsule({0, 0, 0}, {0.1, 0.2, 0}, 0.05), Motion(0.3)},
            {*field, Motion(0.3)}};
  }

  std::mt19937_64 rng_{20240122};
  std::uniform_real_distribution<double> sym_{-1, 1};
};

TEST_F(BodyTest, VelocityIsTheDerivativeOfAMaterialPoint) {
  for (int i = 0; i < 100; ++i) {
    const BodyMotion motion = Motion(1);
    const Vector3d material = Vector(0.3);
    const double u = 0.5 + 0.4 * sym_(rng_), h = 1e-5;
    const auto at = [&](double fraction) { return motion.PoseAt(fraction) * material; };
    const Vector3d difference = (at(u + h) - at(u - h)) / (2 * h * motion.duration);
    EXPECT_LT((motion.VelocityAt(at(u), u) - difference).norm(), 1e-6 * (1 + difference.norm()));
  }
}

TEST_F(BodyTest, WithoutDurationNothingMoves) {
  BodyMotion motion = Motion(1);
  motion.duration = 0;
  EXPECT_EQ(motion.VelocityAt(Vector(1), 0.5), Vector3d::Zero());
}

TEST_F(BodyTest, DistancesTurnAlong) {
  const std::vector<Body> bodies = Bodies();
  for (const Body& body : bodies) {
    for (int i = 0; i < 50; ++i) {
      const double u = 0.5 + 0.5 * sym_(rng_);
      const Vector3d local = Vector(0.2);
      const math::Pose pose = body.motion.PoseAt(u);
      const Distance expected = At(body.shape, local);
      const BodyDistance found = At({&body, 1}, u, pose * local);
      EXPECT_EQ(found.body, 0);
      EXPECT_NEAR(found.distance.distance, expected.distance, 1e-6);
      EXPECT_LT((found.distance.normal - pose.q * expected.normal).norm(), 1e-4);
    }
  }
}

TEST_F(BodyTest, TheDeepestOrNearestAnswers) {
  BodyMotion still, fast;
  fast.end.p = {0.1, 0, 0};
  fast.duration = 0.1;
  const std::vector<Body> bodies = {{Capsule({-1, 0, 0}, {-1, 0, 0}, 0.5), still},
                                    {Capsule({0.5, 0, 0}, {0.5, 0, 0}, 1.2), fast}};
  const auto outside = At(bodies, 0, {-2, 0, 0});
  EXPECT_EQ(outside.body, 0);
  EXPECT_NEAR(outside.distance.distance, 0.5, 1e-12);
  EXPECT_EQ(outside.velocity, Vector3d::Zero());
  const auto overlap = At(bodies, 0, {-0.6, 0, 0});
  EXPECT_EQ(overlap.body, 0);  // 0.1 deep in both; at the step's end the second has moved away.
  EXPECT_EQ(At(bodies, 0, {-0.55, 0, 0}).body, 1);
  EXPECT_EQ(At(bodies, 1, {-0.55, 0, 0}).body, 0);
  EXPECT_LT((At(bodies, 0, {-0.55, 0, 0}).velocity - Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_EQ(At({}, 0, {0, 0, 0}).body, -1);
  EXPECT_EQ(At({}, 0, {0, 0, 0}).distance.distance, std::numeric_limits<double>::infinity());
}

TEST_F(BodyTest, BatchesFollowSingleQueriesAndAllocateNothing) {
  const std::vector<Body> bodies = Bodies();
  std::vector<float> x, y, z;
  for (int i = 0; i < 1001; ++i) {
    const Vector3d p = Vector(0.6);
    x.push_back(static_cast<float>(p.x()));
    y.push_back(static_cast<float>(p.y()));
    z.push_back(static_cast<float>(p.z()));
  }
  std::vector<float> d(x), nx(x), ny(x), nz(x), vx(x), vy(x), vz(x);
  std::vector<int32_t> body(x.size());
  const BodyDistanceSpans out{{d, nx, ny, nz}, vx, vy, vz, body};
  long allocations;
  {
    const mane::fixtures::AllocationCount count;
    At(bodies, 0.3, {x, y, z}, out);
    allocations = count.count();
  }
  EXPECT_EQ(allocations, 0);
  for (size_t i = 0; i < x.size(); ++i) {
    const BodyDistance exact = At(bodies, 0.3, Vector3d(x[i], y[i], z[i]));
    EXPECT_NEAR(d[i], exact.distance.distance, 2e-6);
    if (body[i] != exact.body) continue;  // As near to both.
    EXPECT_LT((Vector3d(nx[i], ny[i], nz[i]) - exact.distance.normal).norm(), 2e-3);
    EXPECT_LT((Vector3d(vx[i], vy[i], vz[i]) - exact.velocity).norm(), 1e-4);
  }
}

}  // namespace
}  // namespace mane::contact
