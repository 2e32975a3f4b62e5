// A capsule's distance against closed forms: beside the segment, beyond its ends, on it, and as a
// sphere; float32 follows double.

#include "contact/capsule.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace mane::contact {
namespace {

using Eigen::Vector3d;

TEST(CapsuleTest, IsACylinderBesideItsSegmentAndSpheresBeyond) {
  const Capsule capsule({0, 1, 0}, {0, 3, 0}, 0.5);
  EXPECT_NEAR(capsule.At({0, 2, 2}).distance, 1.5, 1e-15);
  EXPECT_NEAR(capsule.At({0.1, 2.7, 0}).distance, -0.4, 1e-15);
  EXPECT_NEAR(capsule.At({0, 6, 4}).distance, 4.5, 1e-15);
  EXPECT_LT((capsule.At({0, 6, 4}).normal - Vector3d(0, 0.6, 0.8)).norm(), 1e-15);
  EXPECT_LT((capsule.At({-3, -3, 0}).normal - Vector3d(-0.6, -0.8, 0)).norm(), 1e-15);
  EXPECT_LT((capsule.At({-1, 1.5, 0}).normal - Vector3d(-1, 0, 0)).norm(), 1e-15);
}

TEST(CapsuleTest, LeadsOutAcrossItsSegment) {
  const Capsule capsule({0, 1, 0}, {0, 3, 0}, 0.5);
  const Distance found = capsule.At({0, 2, 0});
  EXPECT_NEAR(found.distance, -0.5, 1e-15);
  EXPECT_NEAR(found.normal.norm(), 1, 1e-15);
  EXPECT_NEAR(found.normal.y(), 0, 1e-15);
}

TEST(CapsuleTest, OfEqualEndsIsASphere) {
  const Capsule capsule({1, 1, 1}, {1, 1, 1}, 0.25);
  EXPECT_NEAR(capsule.At({1, 1, 3}).distance, 1.75, 1e-15);
  EXPECT_NEAR(capsule.At({1, 1, 1}).distance, -0.25, 1e-15);
  EXPECT_NEAR(capsule.At({1, 1, 1}).normal.norm(), 1, 1e-15);
}

TEST(CapsuleTest, Float32FollowsDouble) {
  std::mt19937_64 rng(20240119);
  std::uniform_real_distribution<float> sym(-1, 1);
  const Capsule capsule({-0.2, 0.1, 0}, {0.3, 0.3, 0.2}, 0.1);
  std::vector<float> x(1000), y(x), z(x), d(x), nx(x), ny(x), nz(x);
  for (size_t i = 0; i < x.size(); ++i) x[i] = sym(rng), y[i] = sym(rng), z[i] = sym(rng);
  capsule.At({x, y, z}, {d, nx, ny, nz});
  for (size_t i = 0; i < x.size(); ++i) {
    const Distance exact = capsule.At(Vector3d(x[i], y[i], z[i]));
    EXPECT_NEAR(d[i], exact.distance, 3e-7);
    EXPECT_LT((Vector3d(nx[i], ny[i], nz[i]) - exact.normal).norm(), 1e-5);
  }
}

}  // namespace
}  // namespace mane::contact
