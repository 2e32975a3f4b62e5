// Properties of the bending of one hair:
//   closed form   a stiff beam sags as the textbook's, w L^4 / (8 EI), with the order of the rule
//   soft hair     follows the force and does not overshoot
//   equilibria    hair along or against the force stays
//   superposition forces add, wherever they act
//   symmetry      mirrored and turned scenes have mirrored and turned hair
//   hull          nodes stay out of it, in the plane, and turn no more than they must

#include "beam/bend.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <functional>
#include <vector>

#include "beam/test_hairs.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::NoHull;
using fixtures::Random;

using Weights = std::function<std::vector<double>(int)>;

// n_i^2 alone: what a segment bends by is what its own half bends by.
std::vector<double> PublishedWeights(int k) {
  std::vector<double> weights;
  for (int n = k; n > 0; --n) weights.emplace_back(n * n);
  return weights;
}

// Segments' means of the moment of a load that is spread rather than concentrated.
std::vector<double> SpreadWeights(int k) {
  std::vector<double> weights;
  const auto moment = [&](int n) { return n > k ? 0 : n * n - n + 1.0 / 3; };
  for (int n = k; n > 0; --n) weights.emplace_back(moment(n + 1) + moment(n));
  return weights;
}

// How far the tip of a stiff horizontal beam sags, over w L^4 / (8 EI).
double Sag(int k, const Weights& weights) {
  const double length = 0.3, rho = 5e-6, EI = 1e-3, g = 9.81, d = length / k;
  BendField field;
  field.gravity = {0, -g, 0};
  const BendHair hair{Vector3d::Zero(), Vector3d::UnitX(), d, SoftnessOf(rho, d, EI, k), 0};
  const double sag = -Bend(hair, field, weights(k), NoHull()).back().y();
  return sag / (rho * g * std::pow(length, 4) / (8 * EI));
}

double Order(const Weights& weights) {
  return std::log2((Sag(40, weights) - 1) / (Sag(80, weights) - 1));
}

TEST(BendTest, SagsAsTheTextbooksBeam) {
  EXPECT_NEAR(Sag(640, TurnWeights), 1, 4e-3);
  EXPECT_NEAR(Order(TurnWeights), 1, 0.03);
  EXPECT_NEAR(Sag(640, SpreadWeights), 1, 2e-5);
  EXPECT_NEAR(Order(SpreadWeights), 2, 0.05);
}

TEST(BendTest, ByTheDeflectionOfOneSegmentAloneSagsHalf) {
  EXPECT_NEAR(Sag(640, PublishedWeights), 0.5, 4e-3);
}

TEST(BendTest, SoftHairFollowsTheForce) {
  BendField field;
  field.gravity = {3, -9, 2};
  const Vector3d down = field.gravity.normalized();
  for (const double EI : {1e-9, 1e-11, 1e-13, 1e-15}) {
    const int k = 20;
    const double d = 0.3 / k;
    const BendHair hair{Vector3d::Zero(), Vector3d::UnitY(), d, SoftnessOf(5e-6, d, EI, k), 0};
    const auto nodes = Bend(hair, field, TurnWeights(k), NoHull());
    double before = hair.direction.dot(down);
    const Vector3d plane = hair.direction.cross(down);
    for (int i = 1; i <= k; ++i) {
      const Vector3d e = (nodes[i] - nodes[i - 1]) / d;
      EXPECT_GE(e.dot(down), before - 1e-12);      // Ever nearer to it,
      EXPECT_GE(e.cross(down).dot(plane), -1e-9);  // never beyond,
      EXPECT_NEAR(e.dot(plane), 0, 1e-9);          // in one plane.
      before = e.dot(down);
    }
    if (EI < 1e-10) {
      EXPECT_NEAR(before, 1, 1e-9);
    }
  }
}

TEST(BendTest, HairAlongOrAgainstTheForceStays) {
  BendField field;
  field.gravity = {0, -9.81, 0};
  for (const double side : {1.0, -1.0}) {
    const BendHair hair{Vector3d::Zero(), side * Vector3d::UnitY(), 0.01, 1e4, 0};
    const auto nodes = Bend(hair, field, TurnWeights(20), NoHull());
    EXPECT_LT((nodes.back() - 0.2 * hair.direction).norm(), 1e-14);
  }
}

TEST(BendTest, ForcesActWhereAndOnWhatTheyAreSaidTo) {
  const Hull hull{Vector3d(0.1, 0.2, -0.3), Vector3d(0.08, 0.11, 0.1)};
  BendField field;
  field.gravity = {0, -9.81, 0};
  Force uniform;
  uniform.vector = {1, 2, 3};
  uniform.where = {{Vector3d(0, 2, 0), 1.0}};  // y >= 0.5
  Force toward;
  toward.kind = Force::Kind::kToward;
  toward.point = {1, 1, 1};
  toward.strength = 5;
  toward.softening = 0.1;
  Force around = toward;
  around.kind = Force::Kind::kAround;
  field.forces = {uniform, toward, around};
  const Vector3d high(0, 0.6, 0), low(0, 0.4, 0), near(1, 1, 0.95);
  EXPECT_EQ(AccelerationAt(field, 1, hull, high), field.gravity + uniform.vector);
  EXPECT_EQ(AccelerationAt(field, 1, hull, low), field.gravity);
  EXPECT_EQ(AccelerationAt(field, 0, hull, high), field.gravity);
  const Vector3d pull = AccelerationAt(field, 2, hull, low) - field.gravity;
  EXPECT_LT((pull - 5 * (toward.point - low).normalized()).norm(), 1e-12);
  EXPECT_NEAR((AccelerationAt(field, 2, hull, near) - field.gravity).norm(), 2.5, 1e-12);
  const Vector3d along = AccelerationAt(field, 4, hull, low) - field.gravity;
  EXPECT_NEAR(along.dot(hull.Gradient(low)), 0, 1e-10);
  EXPECT_NEAR(along.dot(pull), along.squaredNorm(), 1e-12);
}

// A scene seen in a mirror or turned about Y by 90 degrees, which swaps radii.
TEST(BendTest, MirroredAndTurnedScenesHaveMirroredAndTurnedHair) {
  Random random(7);
  Eigen::Matrix3d mirror = Vector3d(-1, 1, 1).asDiagonal(), turn;
  turn << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  for (const Eigen::Matrix3d& S : {mirror, turn}) {
    for (int trial = 0; trial < 200; ++trial) {
      const Hull hull = random.AnyHull();
      const BendField field = fixtures::AnyField(random, hull, 3);
      const BendHair hair = fixtures::AnyHair(random, hull, 3 * hull.radii.maxCoeff(), 20);
      Hull other{S * hull.center, (S * hull.radii).cwiseAbs()};
      BendField other_field = field;
      other_field.gravity = S * field.gravity;
      for (Force& force : other_field.forces) {
        force.vector = S * force.vector;
        force.point = S * force.point;
        for (HalfSpace& half : force.where) half.normal = S * half.normal;
      }
      BendHair other_hair = hair;
      other_hair.root = S * hair.root;
      other_hair.direction = S * hair.direction;
      const auto nodes = Bend(hair, field, TurnWeights(20), hull);
      const auto others = Bend(other_hair, other_field, TurnWeights(20), other);
      for (size_t i = 0; i < nodes.size(); ++i) {
        EXPECT_LT((others[i] - S * nodes[i]).norm(), 1e-7 * hull.radii.maxCoeff());
      }
    }
  }
}

TEST(BendTest, TurnsOutInThePlaneAndNoMoreThanItMust) {
  Random random(8);
  int met = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Hull hull = random.AnyHull();
    const double size = hull.radii.minCoeff();
    // One segment beyond a point off the hull, bent into it.
    BendHair hair = fixtures::AnyHair(random, hull, 1, 2);
    hair.root = hull.center + random.Uniform(1, 1.2) * (hair.root - hull.center);
    hair.direction = random.Direction();
    hair.segment_length = random.Uniform(0.05, 0.6) * size;
    BendField field;
    field.gravity = random.Vector(10);
    const double d = hair.segment_length;
    const std::vector<double> weights = {1};
    const Vector3d free = (Bend(hair, field, weights, NoHull())[1] - hair.root) / d;
    const Vector3d e = (Bend(hair, field, weights, hull)[1] - hair.root) / d;
    if (hull.At(hair.root + d * free) >= 0) {
      EXPECT_LT((e - free).norm(), 1e-9);
      continue;
    }
    ++met;
    EXPECT_NEAR(e.norm(), 1, 1e-12);
    EXPECT_GE(hull.At(hair.root + d * e), -1e-12);
    EXPECT_LT(hull.At(hair.root + d * e), 1e-9);  // It lies on the hull,
    const Vector3d plane = hair.direction.cross(free);
    EXPECT_NEAR(e.dot(plane), 0, 1e-9);  // in the plane,
    const Vector3d axis = free.cross(e).normalized();
    const double angle = std::acos(std::clamp(free.dot(e), -1.0, 1.0));
    for (int i = 1; i < 50; ++i) {  // and what is less turned is inside.
      const Vector3d less = Eigen::AngleAxisd(angle * i / 50, axis) * free;
      EXPECT_LT(hull.At(hair.root + d * less), 1e-9);
    }
  }
  EXPECT_GT(met, 300);
}

}  // namespace
}  // namespace mane::beam
