// Properties of what a joint does:
//   (5)       no direction on the sphere is better than the closed form; nothing to align with
//             leaves the joint straight
//   (7)       weights 0 and 1 are all and nothing; between, the closed form
//   head      a segment of exact length ends outside; details are shortened no more than needed
//   frames    carried by the least rotation, smooth over the scalp

#include "styling/joint.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "math/random.h"

namespace mane::styling {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d RandomUnit(math::RandomStream* random) {
  return Vector3d(random->Normal(), random->Normal(), random->Normal()).normalized();
}

TEST(JointTest, NoDirectionIsBetterThanTheClosedForm) {
  math::RandomStream random(1, 0);
  for (int i = 0; i < 50; ++i) {
    const Vector3d phi = random.Uniform(0, 3) * RandomUnit(&random), q0 = RandomUnit(&random);
    const double kappa = random.Uniform(0, 3);
    const auto E = [&](const Vector3d& q) { return phi.dot(q) + kappa * q0.dot(q); };
    const double best = E(BestDirection(phi, kappa, q0));
    double found = -HUGE_VAL;
    for (int k = 0; k < 20000; ++k) found = std::max(found, E(RandomUnit(&random)));
    EXPECT_GE(best, found);
    // The nearest of n random directions lies within about 2/sqrt(n), which costs 2/n of the sum.
    EXPECT_LT(best - found, 12 * 2.0 / 20000 * (phi.norm() + kappa));
  }
}

TEST(JointTest, NothingToAlignWithLeavesTheJointStraight) {
  const Vector3d q0 = Vector3d(1, 2, 3).normalized();
  EXPECT_EQ(BestDirection(Vector3d::Zero(), 0, q0), q0);
  EXPECT_EQ(BestDirection(-0.7 * q0, 0.7, q0), q0);
  EXPECT_LT((BestDirection(-0.7 * q0, 0.6, q0) + q0).norm(), 1e-12);
}

TEST(JointTest, WeightsShareOutTheForce) {
  math::RandomStream random(2, 0);
  for (int i = 0; i < 100; ++i) {
    const Force free{random.Uniform(0, 2) * RandomUnit(&random), random.Uniform(0, 3)};
    const Vector3d psi = RandomUnit(&random), q0 = RandomUnit(&random);
    const Force none = Constrained(free, 0, psi), all = Constrained(free, 1, psi);
    EXPECT_EQ(none.phi, free.phi);
    EXPECT_EQ(none.kappa, free.kappa);
    EXPECT_LT((BestDirection(all.phi, all.kappa, q0) - psi).norm(), 1e-12);
    const double w = random.Uniform();
    const Force some = Constrained(free, w, psi);
    const Vector3d sum =
        (1 - w) * (free.phi + free.kappa * q0) + w * (free.phi.norm() + free.kappa) * psi;
    EXPECT_LT((BestDirection(some.phi, some.kappa, q0) - sum.normalized()).norm(), 1e-12);
  }
  EXPECT_EQ(Constrained({Vector3d::Zero(), 0}, 0.5, Vector3d::UnitX()).phi, Vector3d(0.5, 0, 0));
}

TEST(JointTest, TurnsByTheAngleTowardTheAim) {
  const Vector3d turned = Turned(Vector3d::UnitX(), Vector3d(-5, 3, 0), 0.2);
  EXPECT_LT((turned - Vector3d(std::cos(0.2), std::sin(0.2), 0)).norm(), 1e-12);
  EXPECT_EQ(Turned(Vector3d::UnitX(), Vector3d(-5, 0, 0), 0.2), Vector3d::UnitX());
}

TEST(JointTest, SegmentsStayOutsideEllipsoids) {
  const Obstacles head{{contact::Ellipsoid(Vector3d(0.07, 0.11, 0.09)), {}}};
  math::RandomStream random(3, 0);
  int turned = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3d q0 = RandomUnit(&random), q = RandomUnit(&random);
    Vector3d from = 0.2 * RandomUnit(&random);
    const contact::Distance start = DistanceTo(head, from);
    from -= (start.distance - random.Uniform(0, 0.01)) * start.normal;
    const Vector3d kept = KeptOutside(head, from, 0.01, 1e-3, q0, q);
    EXPECT_NEAR(kept.norm(), 1, 1e-12);
    EXPECT_GE(DistanceTo(head, from + 0.01 * kept).distance, 1e-3);
    if (DistanceTo(head, from + 0.01 * q).distance >= 1e-3) {
      EXPECT_EQ(kept, q);
    }
    turned += kept != q;
  }
  EXPECT_GT(turned, 500);
}

TEST(JointTest, HairThatFallsStraightIntoAHeadFallsToASide) {
  const Obstacles ball{{contact::Ellipsoid(Vector3d(0.1, 0.1, 0.1)), {}}};
  const Vector3d q =
      KeptOutside(ball, {0, 0.1, 0}, 0.01, 1e-3, Vector3d::UnitY(), -Vector3d::UnitY());
  EXPECT_GE(DistanceTo(ball, Vector3d(0, 0.1, 0) + 0.01 * q).distance, 1e-3);
  EXPECT_LT(q.y(), 0.3);
}

TEST(JointTest, DetailsAreShortenedNoMoreThanNeeded) {
  const Obstacles ball{{contact::Ellipsoid(Vector3d(0.1, 0.1, 0.1)), {}}};
  const Vector3d joint(0, 0.11, 0);
  EXPECT_EQ(ShortenedDetails(ball, joint, {0, 0.02, 0}, 1e-3), Vector3d(0, 0.02, 0));
  const Vector3d kept = ShortenedDetails(ball, joint, {0, -0.02, 0}, 1e-3);
  EXPECT_LE(kept.y(), -0.009 + 0.02 / 64);
  EXPECT_GE(kept.y(), -0.009);
}

TEST(JointTest, FramesTurnTheLeast) {
  math::RandomStream random(4, 0);
  for (int i = 0; i < 200; ++i) {
    const Vector3d d = RandomUnit(&random), q = RandomUnit(&random);
    const Quaterniond root = RootFrame(d);
    EXPECT_LT((root * Vector3d::UnitX() - d).norm(), 1e-12);
    const Quaterniond next = Transported(root, q);
    EXPECT_LT((next * Vector3d::UnitX() - q).norm(), 1e-12);
    EXPECT_NEAR(next.angularDistance(root), std::acos(d.dot(q)), 1e-7);
  }
  // Over the scalp neighbours' frames are neighbours: turned by up to 1 / (1 + cos) times more.
  for (double polar = 0; polar < 2.3; polar += 0.1) {
    for (double azimuth = 0; azimuth < 6.3; azimuth += 0.1) {
      const auto at = [&](double a) {
        return RootFrame(
            {std::sin(polar) * std::cos(a), std::cos(polar), std::sin(polar) * std::sin(a)});
      };
      EXPECT_LT(at(azimuth).angularDistance(at(azimuth + 0.01)), 0.021);
    }
  }
}

}  // namespace
}  // namespace mane::styling
