// Properties of energies and forces:
//   values       elastic, gravity and kinetic energy agree with brute-force integration
//   gradient     agrees with finite differences of the brute-force energies
//   invariance   turning clamp and gravity together changes nothing; nor does moving the clamp
//   rest         without gravity the natural shape has no force and no energy

#include "rod/energy.h"

#include <gtest/gtest.h>

#include "base/check_failure.h"
#include "rod/scheme.h"
#include "rod/test_oracle.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using oracle::Real;

class EnergyTest : public ::testing::TestWithParam<double> {
 protected:
  fixtures::Random random_{99};
};

// Up to 20 rad an element: 48 points integrate that to round-off.
INSTANTIATE_TEST_SUITE_P(Angles, EnergyTest, ::testing::Values(0.0, 1e-8, 1.0, 6.0, 12.0));

TEST_P(EnergyTest, EnergiesAgreeWithBruteForce) {
  for (const int N : {1, 2, 5, 10}) {
    const Strand strand = random_.UnevenStrand(N, 0.2, 2);
    const math::Pose clamp = random_.Pose();
    const std::vector<Vector3d> theta = random_.Vectors(N, GetParam());
    const Vector3d gravity = random_.Vector(10);
    const oracle::Rod rod(strand);
    const double U = static_cast<double>(rod.Elastic(oracle::Stack(theta)));
    EXPECT_NEAR(ElasticEnergy(strand, theta), U, 1e-14 * U);
    const double V = static_cast<double>(
        rod.Gravity(oracle::ToFrame(clamp), gravity.cast<Real>(), oracle::Stack(theta)));
    const double L = strand.TotalLength();
    const double scale = strand.linear_density * gravity.norm() * L * L;
    EXPECT_NEAR(GravityPotential(strand, clamp, gravity, theta), V,
                1e-14 * (1 + GetParam()) * scale);
  }
}

TEST_P(EnergyTest, GradientAgreesWithFiniteDifferences) {
  for (const int N : {1, 2, 5}) {
    const Strand strand = random_.UnevenStrand(N, 0.2, 2);
    const math::Pose clamp = random_.Pose();
    const std::vector<Vector3d> theta = random_.Vectors(N, GetParam());
    const Vector3d gravity = random_.Vector(10);
    std::vector<Vector3d> gradient(N);
    PotentialGradient(strand, clamp, gravity, theta, gradient);
    const oracle::Vector mine = oracle::Stack(gradient);
    const oracle::Vector brute = oracle::Rod(strand).Gradient(
        oracle::ToFrame(clamp), gravity.cast<Real>(), oracle::Stack(theta));
    EXPECT_LT(static_cast<double>((mine - brute).norm()),
              1e-12 * static_cast<double>(brute.norm()));
  }
}

TEST_P(EnergyTest, OnlyTheAngleBetweenClampAndGravityCounts) {
  const Strand strand = random_.UnevenStrand(5, 0.2, 2);
  const std::vector<Vector3d> theta = random_.Vectors(5, GetParam());
  const math::Pose clamp = random_.Pose();
  const Eigen::Quaterniond turn = random_.Rotation();
  const math::Pose elsewhere{random_.Vector(3), turn * clamp.q};
  const Vector3d gravity(1, -9, 2);
  const double V = GravityPotential(strand, clamp, gravity, theta);
  EXPECT_NEAR(GravityPotential(strand, elsewhere, turn * gravity, theta), V, 1e-12 * std::abs(V));
  std::vector<Vector3d> a(5), b(5);
  PotentialGradient(strand, clamp, gravity, theta, a);
  PotentialGradient(strand, elsewhere, turn * gravity, theta, b);
  EXPECT_LT(static_cast<double>((oracle::Stack(a) - oracle::Stack(b)).norm()),
            1e-12 * static_cast<double>(oracle::Stack(a).norm()));
}

TEST(KineticEnergyTest, IsTheQuadraticFormOfTheMassMatrix) {
  fixtures::Random random(17);
  const Strand strand = random.UnevenStrand(4, 0.2, 0.2);
  const oracle::Frame clamp = oracle::ToFrame(random.Pose());
  const oracle::Vector theta = oracle::Stack(random.Vectors(4, 0.2)),
                       rate = oracle::Stack(random.Vectors(4, 5));
  const oracle::Rod rod(strand);
  const auto J = rod.Jacobians(clamp, theta, oracle::GaussRule(kGaussPoints));
  std::vector<Vector3d> velocity;
  for (const oracle::Matrix3X& Jk : J) velocity.push_back((Jk * rate).cast<double>());
  const double T = static_cast<double>(rate.dot(rod.StepMass(clamp, theta) * rate) / 2);
  EXPECT_NEAR(KineticEnergy(strand, velocity) / T, 1, 1e-12);
}

TEST(KineticEnergyTest, OfARigidTranslationIsHalfMassTimesSpeedSquared) {
  const Strand strand = fixtures::Random(18).UnevenStrand(3, 0.2, 1);
  const std::vector<Vector3d> velocity(3 * kGaussPoints, Vector3d(1, 2, -2));
  EXPECT_NEAR(
      KineticEnergy(strand, velocity) / (0.5 * strand.linear_density * strand.TotalLength() * 9), 1,
      1e-14);
}

TEST(RestTest, NaturalShapeHasNoForceAndNoEnergyWithoutGravity) {
  for (const fixtures::Hair& hair : fixtures::AppendixB()) {
    const Strand strand = fixtures::MakeStrand(hair, 0.2, 5);
    const fixtures::State state(strand);
    std::vector<Vector3d> gradient(5);
    PotentialGradient(strand, {}, Vector3d::Zero(), state.theta, gradient);
    const double moment = strand.stiffness.maxCoeff() * (1 + strand.natural[0].norm());
    for (const Vector3d& g : gradient) EXPECT_LT(g.norm(), 1e-15 * moment) << hair.name;
    EXPECT_LT(ElasticEnergy(strand, state.theta), 1e-28 * moment);
  }
}

TEST(RestTest, RefusesAGradientOfTheWrongSize) {
  const Strand strand = fixtures::HeavyStrand(1, 3);
  const fixtures::State state(strand);
  std::vector<Vector3d> two(2);
  EXPECT_THROW(PotentialGradient(strand, {}, Vector3d::Zero(), state.theta, two),
               base::CheckFailure);
}

}  // namespace
}  // namespace mane::rod
