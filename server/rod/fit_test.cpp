// Properties of a fit:
//   exact        a piecewise helix sampled at 25 to 100 points comes back, points and length
//   order        the distance from smooth space curves falls at third order in N
//   noise        the fit of noisy points is nearer to the true curve than the noise
//   bound        the fewest elements that keep within it are found
//   frames       a prescribed root frame is kept; translation, turning and scale go through
//   twist        straight and planar hair is not twisted
//   no sag       an imported strand rests in its imported shape, in statics and in dynamics

#include "rod/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>
#include <vector>

#include "rod/chain.h"
#include "rod/inverse_statics.h"
#include "rod/statics.h"
#include "rod/test_curves.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Coil;
using fixtures::Curve;
using fixtures::Deviation;
using fixtures::kGravity;
using fixtures::kL;
using fixtures::Length;
using fixtures::PlaneWave;
using fixtures::Points;
using fixtures::Random;
using fixtures::Sample;
using fixtures::SpaceWave;

TEST(FitTest, RecoversAPiecewiseHelix) {
  Random random(701);
  for (const double angle : {0.3, 1.0, 2.0}) {
    for (const int N : {1, 2, 3, 5}) {
      for (const int n : {50, 100}) {
        SCOPED_TRACE(testing::Message() << angle << " " << N << " " << n);
        const std::vector<double> length(N, kL / N);
        const math::Pose root = random.Pose();
        const Points points = Sample(length, root, random.Vectors(N, angle), n);
        const Fit fit = FitPolyline(points, {.elements = N});
        EXPECT_LT(fit.largest_distance, 1e-7 * kL);
        EXPECT_NEAR(Length(fit), kL, 1e-7 * kL);
        EXPECT_LT((fit.root.q * Vector3d::UnitX() - root.q * Vector3d::UnitX()).norm(), 1e-4);
        const Points again = Sample(fit, n);
        for (int i = 0; i < n; ++i) EXPECT_LT((again[i] - points[i]).norm(), 1e-6 * kL);
      }
    }
  }
}

// Curvatures that jump from element to element are known only by few points each: within 1e-3 L
// always, exactly for most.
TEST(FitTest, RecoversManyElementsClosely) {
  Random random(702);
  int exact = 0;
  for (int i = 0; i < 30; ++i) {
    SCOPED_TRACE(i);
    const int N = i % 2 ? 10 : 20;
    const Points points =
        Sample(std::vector<double>(N, kL / N), random.Pose(), random.Vectors(N, 1), 100);
    const Fit fit = FitPolyline(points, {.elements = N});
    EXPECT_LT(fit.largest_distance, 1e-3 * kL);
    exact += fit.largest_distance < 1e-7 * kL;
  }
  EXPECT_GE(exact, 5);
}

TEST(FitTest, RecoversGivenProportions) {
  Random random(703);
  const std::vector<double> length = {0.02, 0.03, 0.05, 0.1};
  const Points points = Sample(length, random.Pose(), random.Vectors(4, 0.8), 60);
  const Fit fit = FitPolyline(points, {.elements = 4, .proportions = {2, 3, 5, 10}});
  EXPECT_LT(fit.largest_distance, 1e-7 * kL);
  for (int Q = 0; Q < 4; ++Q) EXPECT_NEAR(fit.length[Q], length[Q], 1e-7);
}

TEST(FitTest, DistanceFallsAtThirdOrder) {
  const std::vector<std::pair<Curve, std::vector<int>>> cases = {
      {Coil, {4, 5, 6, 8, 10}}, {PlaneWave, {6, 8, 12, 16, 24}}, {SpaceWave, {6, 8, 12, 16, 24}}};
  for (const auto& [curve, elements] : cases) {
    std::vector<double> x, y;
    for (const int N : elements) {
      const Fit fit = FitPolyline(Sample(curve, 100), {.elements = N, .noise = 0});
      x.push_back(std::log(N));
      y.push_back(std::log(fit.rms_distance));
    }
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (size_t i = 0; i < x.size(); ++i) mx += x[i] / x.size(), my += y[i] / y.size();
    for (size_t i = 0; i < x.size(); ++i) {
      xx += (x[i] - mx) * (x[i] - mx);
      xy += (x[i] - mx) * (y[i] - my);
    }
    EXPECT_LT(xy / xx, -2.7);
    EXPECT_LT(std::exp(y.back()), 2e-5);
  }
}

TEST(FitTest, AveragesNoise) {
  Random random(704);
  for (const Curve& curve : {Curve(Coil), Curve(PlaneWave), Curve(SpaceWave)}) {
    for (const double sigma : {2e-4, 5e-4}) {
      for (const int n : {50, 100}) {
        SCOPED_TRACE(testing::Message() << sigma << " " << n);
        Points points = Sample(curve, n);
        const Vector3d root = points[0];
        for (Vector3d& x : points) x += random.Vector(std::sqrt(3.0) * sigma);
        points[0] = root;
        const Fit fit = FitPolyline(points, {.elements = 10, .noise = sigma});
        // Of 3 n numbers 33 are spent; what is across the curve is two thirds.
        EXPECT_LT(fit.rms_distance, 2 * sigma);
        EXPECT_GT(fit.rms_distance, 0.7 * sigma);
        EXPECT_LT(Deviation(fit, curve), 3.5 * sigma);
        EXPECT_NEAR(Length(fit), Length(FitPolyline(Sample(curve, 400), {.elements = 10})),
                    0.02 * Length(fit));
        // Estimated rather than given, where there are points enough.
        if (n < 100) continue;
        const double noise = FitPolyline(points, {.elements = 10}).noise;
        EXPECT_GT(noise, 0.3 * sigma);
        EXPECT_LT(noise, 1.3 * sigma);
      }
    }
  }
}

TEST(FitTest, FindsTheFewestElementsWithinABound) {
  const Points points = Sample(SpaceWave, 60);
  int last = 1000;
  for (const double bound : {2e-5, 2e-4, 1e-3, 4e-3}) {
    const Fit fit = FitPolyline(points, {.elements = 64, .bound = bound});
    EXPECT_TRUE(fit.bound_met);
    EXPECT_LE(fit.largest_distance, bound);
    const int N = static_cast<int>(fit.theta.size());
    EXPECT_LT(N, last);
    last = N;
    if (N > 1) {
      EXPECT_GT(FitPolyline(points, {.elements = N - 1}).largest_distance, bound);
    }
  }
  const Fit missed = FitPolyline(points, {.elements = 3, .bound = 1e-5});
  EXPECT_FALSE(missed.bound_met);
  EXPECT_EQ(missed.theta.size(), 3u);
  EXPECT_GT(missed.largest_distance, 1e-5);
}

TEST(FitTest, KeepsAPrescribedRootFrame) {
  Random random(705);
  for (int i = 0; i < 20; ++i) {
    const Points theta = random.Vectors(4, 0.7);
    const math::Pose root = random.Pose();
    const Points points = Sample(std::vector<double>(4, kL / 4), root, theta, 50);
    const Fit fit = FitPolyline(points, {.elements = 4, .root = root.q});
    EXPECT_EQ(fit.root.q.coeffs(), root.q.coeffs());
    // With the frame the angles are determined as well.
    for (int Q = 0; Q < 4; ++Q) EXPECT_LT((fit.theta[Q] - theta[Q]).norm(), 1e-3) << i;
    // A frame off the tangent is kept as well, and bends the first element.
    const Eigen::Quaterniond off = root.q * Eigen::AngleAxisd(0.5, Vector3d::UnitY());
    const Fit bent = FitPolyline(points, {.elements = 12, .root = off});
    EXPECT_EQ(bent.root.q.coeffs(), off.coeffs());
    EXPECT_LT(bent.largest_distance, 0.02 * kL);
  }
}

TEST(FitTest, TurnsAndScalesWithItsInput) {
  const Points points = Sample(Coil, 50);
  const Fit fit = FitPolyline(points, {.elements = 6});
  const math::Pose turn = Random(706).Pose();
  for (const double scale : {1e-6, 1.0, 1e6}) {
    Points moved;
    for (const Vector3d& x : points) moved.push_back(scale * (turn * x));
    const Fit other = FitPolyline(moved, {.elements = 6});
    EXPECT_NEAR(Length(other) / scale, Length(fit), 1e-4 * Length(fit));
    EXPECT_NEAR(other.rms_distance / scale, fit.rms_distance, 1e-2 * fit.rms_distance);
  }
}

TEST(FitTest, DoesNotTwistStraightOrPlaneHair) {
  Random random(707);
  for (const int n : {2, 3, 25, 100}) {
    Points line, noisy;
    for (int i = 0; i < n; ++i) {
      line.push_back({0, 0, -kL * i / (n - 1)});
      noisy.push_back(line.back() + random.Vector(1e-4));
    }
    const Fit straight = FitPolyline(line, {.elements = 8});
    EXPECT_LT(straight.largest_distance, 1e-9);
    EXPECT_NEAR(Length(straight), kL, 1e-9);
    for (const Vector3d& theta : straight.theta) EXPECT_LT(theta.norm(), 1e-6);
    if (n < 25) continue;
    const Fit fit = FitPolyline(noisy, {.elements = 8, .noise = 6e-5});
    for (const Vector3d& theta : fit.theta) EXPECT_LT(theta.norm(), 0.2);
  }
  for (const Vector3d& theta : FitPolyline(Sample(PlaneWave, 60), {.elements = 10}).theta) {
    EXPECT_LT(std::abs(theta.x()), 1e-3);
  }
}

// A hair with the fitted shape and the section of a row of Appendix B.
Strand HairOf(const Fit& fit, int row) {
  Strand strand =
      fixtures::MakeStrand(fixtures::AppendixB()[row], 1, static_cast<int>(fit.theta.size()));
  strand.length = fit.length;
  return strand;
}

TEST(FitTest, ImportedHairRestsInItsShape) {
  Random random(709);
  for (const Curve& curve : {Curve(Coil), Curve(PlaneWave), Curve(SpaceWave)}) {
    for (const int row : {0, 1, 2}) {
      SCOPED_TRACE(row);
      const math::Pose placed = random.Pose();
      Points points = Sample(curve, 60);
      for (Vector3d& x : points) x = placed * x;
      const Fit fit = FitPolyline(points, {.elements = 10});
      Strand strand = HairOf(fit, row);
      const HoldReport report =
          HoldShape(strand, fit.root, kGravity, fit.theta, {1, 1e4, 0.1, 0.02});
      ASSERT_TRUE(report.held);
      const Vector3d tip = ElementFrames(strand, fit.root, fit.theta).back().r;
      const auto off = [&](const Points& theta) {
        return (ElementFrames(strand, fit.root, theta).back().r - tip).norm() / Length(fit);
      };
      Points theta = fit.theta;
      for (Vector3d& v : theta) v += random.Vector(0.01);
      EXPECT_TRUE(SolveRestShape(strand, fit.root, kGravity, theta).converged);
      EXPECT_LT(off(theta), 1e-6);

      fixtures::State state(strand);
      state.theta = fit.theta;
      StepScratch scratch;
      for (int frame = 0; frame < 1200; ++frame) {
        ASSERT_TRUE(Step(strand, {fit.root, fit.root, 1.0 / 240}, {.gravity = kGravity},
                         state.View(), scratch));
      }
      EXPECT_LT(off(state.theta), 1e-6);
    }
  }
}

}  // namespace
}  // namespace mane::rod
