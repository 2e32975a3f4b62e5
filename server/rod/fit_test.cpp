// Properties of a fit:
//   exact        a piecewise helix sampled at 25 to 100 points comes back, points and length
//   order        the distance from smooth space curves falls at third order in N
//   noise        the fit of noisy points is nearer to the true curve than the noise
//   bound        the fewest elements that keep within it are found
//   frames       a prescribed root frame is kept; translation, turning and scale go through
//   twist        straight and planar hair is not twisted
//   any input    degenerate and random polylines give finite answers, and honest distances
//   no sag       an imported strand rests in its imported shape, in statics and in dynamics

#include "rod/fit.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numeric>

#include "rod/chain.h"
#include "rod/helix.h"
#include "rod/inverse_statics.h"
#include "rod/test_strands.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using fixtures::Random;
using Points = std::vector<Vector3d>;

constexpr double kL = 0.2;
const Vector3d kGravity(0, -9.81, 0);

double Length(const Fit& fit) { return std::accumulate(fit.length.begin(), fit.length.end(), 0.0); }

// Points at equal steps of a strand.
Points Sample(const std::vector<double>& length, const math::Pose& root, const Points& theta,
              int n) {
  Strand strand;
  strand.length = length;
  const std::vector<ElementFrame> frames = ElementFrames(strand, root, theta);
  Points points;
  for (int i = 0; i < n; ++i) {
    const auto [Q, u] = Locate(strand, strand.TotalLength() * i / (n - 1));
    points.push_back(frames[Q].r + length[Q] * (frames[Q].R * PointOnElement(theta[Q], u).p));
  }
  return points;
}
Points Sample(const Fit& fit, int n) { return Sample(fit.length, fit.root, fit.theta, n); }

using Curve = std::function<Vector3d(double)>;

Points Sample(const Curve& curve, int n) {
  Points points;
  for (int i = 0; i < n; ++i) points.push_back(curve(static_cast<double>(i) / (n - 1)));
  return points;
}

// Largest distance of points of the fit from the curve, by brute force: 1 + kL / 20000 of slack.
double Deviation(const Fit& fit, const Curve& curve) {
  const Points fine = Sample(curve, 20001);
  double worst = 0;
  for (const Vector3d& x : Sample(fit, 101)) {
    double nearest = 1e300;
    for (const Vector3d& y : fine) nearest = std::min(nearest, (x - y).squaredNorm());
    worst = std::max(worst, std::sqrt(nearest));
  }
  return worst;
}

// Two turns of growing pitch; a plane elastica-like wave; a wave in space.
Vector3d Coil(double t) {
  const double a = 4 * M_PI * (t + 0.3 * t * t);
  return {0.02 * std::cos(a), 0.02 * std::sin(a), 0.15 * t * (1 + 0.5 * t)};
}
Vector3d PlaneWave(double t) { return {0.2 * t, 0.03 * std::sin(7 * t), 0}; }
Vector3d SpaceWave(double t) { return {0.2 * t, 0.02 * std::sin(7 * t), 0.03 * t * t}; }

void ExpectFinite(const Fit& fit) {
  EXPECT_TRUE(std::isfinite(fit.largest_distance) && std::isfinite(fit.rms_distance));
  EXPECT_TRUE(fit.root.p.allFinite() && fit.root.q.coeffs().allFinite());
  EXPECT_NEAR(fit.root.q.norm(), 1, 1e-12);
  for (const Vector3d& theta : fit.theta) EXPECT_TRUE(theta.allFinite());
  for (const double l : fit.length) EXPECT_TRUE(std::isfinite(l) && l > 0);
  EXPECT_LE(fit.rms_distance, fit.largest_distance * (1 + 1e-12));
}

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

TEST(FitTest, DegenerateInputGivesFiniteAnswers) {
  const Vector3d a(1, 2, 3), b(1, 2.1, 3), c(1.05, 2.1, 3);
  const std::vector<Points> inputs = {{a},
                                      {a, a, a},
                                      {a, b},
                                      {a, a, b, b, b, c, c},
                                      {a, b, a},
                                      {a, b, a, b, a, b},
                                      {a, b, c, a},
                                      {a, b, b + Vector3d(1e-13, 0, 0), c},
                                      {a, a + 1e-9 * c, b},
                                      {a, a + Vector3d(1e-200, 0, 0)},
                                      {1e20 * a, 1e20 * b, 1e20 * c},
                                      {Vector3d::Zero(), 1e-20 * a, 1e-20 * c}};
  for (size_t i = 0; i < inputs.size(); ++i) {
    for (const int N : {1, 5, 20}) {
      SCOPED_TRACE(testing::Message() << i << " " << N);
      const Fit fit = FitPolyline(inputs[i], {.elements = N});
      ExpectFinite(fit);
      EXPECT_EQ(fit.theta.size(), static_cast<size_t>(N));
      EXPECT_EQ(fit.root.p, inputs[i][0]);
      ExpectFinite(FitPolyline(inputs[i], {.elements = N, .bound = 1e-4}));
      ExpectFinite(FitPolyline(inputs[i], {.elements = N, .root = Eigen::Quaterniond(0, 1, 0, 0)}));
    }
  }
  EXPECT_LT(FitPolyline(inputs[3], {.elements = 20}).largest_distance, 1e-3);
}

TEST(FitTest, AnyPolylineGivesAFiniteHonestAnswer) {
  Random random(708);
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    Points points = {random.Vector(1)};
    const int n = 2 + static_cast<int>(random.Uniform(0, 99));
    const double wander = random.Uniform(0, 2);
    Vector3d direction = random.Direction();
    for (int k = 1; k < n; ++k) {
      direction = (direction + wander * random.Vector(1)).normalized();
      points.push_back(points.back() + kL / n * std::pow(10, random.Uniform(-3, 0)) * direction);
    }
    const Fit fit = FitPolyline(points, {.elements = 1 + i % 20});
    ExpectFinite(fit);
    // No point is farther from the centreline than reported.
    const Points fine = Sample(fit, 4001);
    for (const Vector3d& x : points) {
      double nearest = 1e300;
      for (const Vector3d& y : fine) nearest = std::min(nearest, (x - y).norm());
      EXPECT_LE(nearest, fit.largest_distance + Length(fit) / 4000);
    }
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
