// Properties of the sampled wound strand:
//   reference    agrees with a fine RK4 integration of the axis and the tangent off it, which
//                shares no code, also where the axis turns about as fast as the coil
//   closed form  the natural shape is the Super-Helix of the natural curvatures; a straight axis is
//                that of the changed ones; a coil pulled out is a straight line
//   arc length   the hair has unit speed, across joints too, and no gaps; polylines are never
//   longer frames       moving the root moves every point rigidly

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <vector>

#include "base/check_failure.h"
#include "wire/reconstruct.h"

namespace mane::wire {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::Vector4d;

struct Strand {
  math::Pose root;
  std::vector<double> lengths;
  std::vector<Vector3d> natural;
  std::vector<Vector4d> x;

  double TotalLength() const { return std::accumulate(lengths.begin(), lengths.end(), 0.0); }
};

std::vector<Vector3d> Sampled(const Strand& s, size_t points) {
  std::vector<Vector3d> out(points);
  SampleWoundPoints(s.root, s.lengths, s.natural, s.x, std::span(out));
  return out;
}

// A coil's axis, its direction towards the hair's tangent, and their product, as C1 has them.
Matrix3d FrameOf(const Vector3d& natural) {
  Matrix3d F;
  F.col(0) = natural.normalized();
  F.col(1) = (Vector3d::UnitX() - F(0, 0) * F.col(0)).normalized();
  F.col(2) = Vector3d(F.col(0)).cross(Vector3d(F.col(1)));
  return F;
}

// What C3 says of an element: angles of the axis, and the tangent's direction off it.
struct Axis {
  Vector3d beta;
  double slope;  // Of the tangent to the axis [rad].
};

Axis AxisOf(const Vector3d& natural, double l, const Vector4d& x) {
  const double W = natural.norm() * l;
  const double alpha = std::atan2(natural.tail<2>().norm(), natural.x());
  return {{std::hypot(W + x[0], x[3]) - W, x[1], x[2]}, alpha - std::atan2(x[3], W + x[0])};
}

// Integrates A' = A [beta], r' = l A (cos slope, sin slope (cos phase, sin phase)) over arc length
// `s` of the strand, `steps` to an element.
Vector3d Integrated(const Strand& strand, double s, int steps) {
  Matrix3d A = strand.root.q.toRotationMatrix() * FrameOf(strand.natural[0]);
  Vector3d r = strand.root.p;
  double phase = 0;
  for (size_t q = 0; q < strand.lengths.size() && s > 0; ++q) {
    const double l = strand.lengths[q], W = strand.natural[q].norm() * l;
    const Axis axis = AxisOf(strand.natural[q], l, strand.x[q]);
    const auto tangent = [&](double u) {
      const double at = phase + W * u;
      return Vector3d(std::cos(axis.slope), std::sin(axis.slope) * std::cos(at),
                      std::sin(axis.slope) * std::sin(at));
    };
    const auto turn = [&](const Matrix3d& frame) -> Matrix3d {
      return frame * math::Cross(axis.beta);
    };
    const double h = std::min(s / l, 1.0) / steps;
    for (int i = 0; i < steps; ++i) {
      const Matrix3d k1 = turn(A), k2 = turn(A + h / 2 * k1), k3 = turn(A + h / 2 * k2),
                     k4 = turn(A + h * k3);
      const Vector3d v1 = A * tangent(i * h), v2 = (A + h / 2 * k1) * tangent((i + 0.5) * h),
                     v3 = (A + h / 2 * k2) * tangent((i + 0.5) * h),
                     v4 = (A + h * k3) * tangent((i + 1) * h);
      A += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
      r += l * h / 6 * (v1 + 2 * v2 + 2 * v3 + v4);
    }
    phase += W;
    s -= l;
  }
  return r;
}

class WoundReconstructTest : public ::testing::Test {
 protected:
  double Symmetric() { return unit_(rng_); }
  Vector3d RandomVector() { return {Symmetric(), Symmetric(), Symmetric()}; }

  // Curly hair of `n` elements between 1 and 5 cm, whose curl varies; x up to `bend` [rad].
  Strand RandomStrand(int n, double bend = 2) {
    Strand s;
    s.root.p = RandomVector();
    s.root.q = math::FromRotationVector(3 * RandomVector());
    for (int q = 0; q < n; ++q) {
      s.lengths.push_back(0.03 + 0.02 * Symmetric());
      s.natural.emplace_back(Vector3d(80, 150, -60) + 30 * RandomVector());
      s.x.push_back(bend * Vector4d(Symmetric(), Symmetric(), Symmetric(), Symmetric()));
    }
    return s;
  }

  // Of one natural curvature, in its natural shape.
  Strand EvenStrand(const Vector3d& natural) {
    Strand s = RandomStrand(5, 0);
    std::fill(s.natural.begin(), s.natural.end(), natural);
    return s;
  }

  // The Super-Helix of the strand's root and lengths and of curvatures `kappa` [rad/m].
  static std::vector<Vector3d> Helix(const Strand& s, const Vector3d& kappa, size_t points) {
    std::vector<Vector3d> theta, out(points);
    for (const double l : s.lengths) theta.emplace_back(l * kappa);
    SamplePoints(s.root, s.lengths, theta, std::span(out));
    return out;
  }

  // Axis angles times those that make |beta| exactly as large as the winding, times `part`.
  static void BendAsFastAsTheCoil(Strand& s, double part) {
    for (size_t q = 0; q < s.x.size(); ++q) {
      s.x[q][0] = s.x[q][3] = 0;
      const double W = s.natural[q].norm() * s.lengths[q];
      s.x[q] *= part * W / s.x[q].norm();
    }
  }

 private:
  std::mt19937_64 rng_{20060730};
  std::uniform_real_distribution<double> unit_{-1, 1};
};

TEST_F(WoundReconstructTest, AgreesWithAnIndependentIntegratorForAnyNumberOfUnequalElements) {
  for (const int n : {1, 2, 5, 17}) {
    SCOPED_TRACE(n);
    const Strand strand = RandomStrand(n);
    const auto points = Sampled(strand, 11);
    for (size_t i = 0; i < points.size(); ++i) {
      const double s = strand.TotalLength() * static_cast<double>(i) / 10;
      // RK4's error per element is about l W^5 / (2880 steps^4) < 2e-11 m.
      EXPECT_LT((points[i] - Integrated(strand, s, 600)).norm(), 1e-9) << "point " << i;
    }
  }
}

TEST_F(WoundReconstructTest, OneFormulaHoldsHoweverFastTheAxisTurns) {
  for (const double part :
       {0.0, 1e-200, 1e-12, 1e-6, 0.5, 1 - 1e-9, 1.0, 1 + 1e-15, 1 + 1e-6, 3.0}) {
    SCOPED_TRACE(part);
    Strand strand = RandomStrand(3);
    BendAsFastAsTheCoil(strand, part);
    const auto points = Sampled(strand, 8);
    for (size_t i = 0; i < points.size(); ++i) {
      const double s = strand.TotalLength() * static_cast<double>(i) / 7;
      EXPECT_LT((points[i] - Integrated(strand, s, 1500)).norm(), 2e-9) << "point " << i;
    }
  }
}

TEST_F(WoundReconstructTest, TheNaturalShapeIsTheHelixOfItsCurvatures) {
  // Curly, fuzzy, left-handed, flat, and nearly a pure twist.
  for (const Vector3d& natural :
       {Vector3d(94, 80, 120), Vector3d(150, 0, 1880), Vector3d(-94, 80, -120),
        Vector3d(0, -300, 0), Vector3d(300, 1e-6, 0)}) {
    SCOPED_TRACE(natural.transpose());
    const Strand strand = EvenStrand(natural);
    const auto expected = Helix(strand, natural, 64), actual = Sampled(strand, 64);
    for (size_t i = 0; i < 64; ++i) EXPECT_LT((actual[i] - expected[i]).norm(), 1e-13) << i;
  }
}

TEST_F(WoundReconstructTest, AStraightAxisIsTheHelixOfTheChangedStrain) {
  // Twisted, untwisted through zero, stretched, and both, at one rate along the whole strand.
  const Vector3d natural(94, 80, 120);
  const double omega = natural.norm();
  for (const auto& [u, xi] :
       {std::pair{40.0, 0.0}, {-2 * omega, 0.0}, {0.0, 90.0}, {-100.0, -70.0}}) {
    SCOPED_TRACE(::testing::Message() << u << ", " << xi);
    Strand strand = EvenStrand(natural);
    for (size_t q = 0; q < strand.x.size(); ++q)
      strand.x[q] = strand.lengths[q] * Vector4d(u, 0, 0, xi);
    const auto actual = Sampled(strand, 40);
    // The axis keeps its direction at the root; the helix keeps its tangent there.
    const Matrix3d F = FrameOf(natural);
    const Vector3d kappa = F * Vector3d(omega + u, xi, 0);
    const double turn = std::atan2(xi, omega + u);
    strand.root.q =
        strand.root.q * Eigen::Quaterniond(Eigen::AngleAxisd(-turn, Vector3d(F.col(2))));
    const auto expected = Helix(strand, kappa, 40);
    for (size_t i = 0; i < 40; ++i) EXPECT_LT((actual[i] - expected[i]).norm(), 1e-13) << i;
  }
}

TEST_F(WoundReconstructTest, APulledOutCoilIsAStraightLineAlongTheAxis) {
  Strand strand = EvenStrand({94, 80, 120});
  const double omega = strand.natural[0].norm(), alpha = std::acos(94 / omega);
  for (size_t q = 0; q < strand.x.size(); ++q) {  // lambda = 1, at half the natural winding.
    const double W = omega * strand.lengths[q];
    strand.x[q] = {0.5 * W * std::cos(alpha) - W, 0, 0, 0.5 * W * std::sin(alpha)};
  }
  const Vector3d axis = strand.root.q * strand.natural[0].normalized();
  const auto points = Sampled(strand, 30);
  for (size_t i = 0; i < points.size(); ++i) {
    const double s = strand.TotalLength() * static_cast<double>(i) / 29;
    EXPECT_LT((points[i] - (strand.root.p + s * axis)).norm(), 1e-14) << i;
  }
}

TEST_F(WoundReconstructTest, TheHairHasUnitSpeedAndNoGaps) {
  for (int trial = 0; trial < 10; ++trial) {
    const Strand strand = RandomStrand(1 + trial % 5);
    constexpr size_t kPoints = 20'001;
    const auto points = Sampled(strand, kPoints);
    EXPECT_EQ(points[0], strand.root.p);
    const double spacing = strand.TotalLength() / (kPoints - 1);
    double length = 0;
    int bent = 0;
    for (size_t i = 1; i < kPoints; ++i) {
      const double step = (points[i] - points[i - 1]).norm();
      length += step;
      EXPECT_LE(step, spacing * (1 + 1e-9)) << i;
      // An arc of curvature k is longer than its chord by (k spacing)^2 / 24 of itself, k < 400.
      // Only in the steps that hold a joint can the tangent's turn make it shorter.
      if (step < spacing * (1 - 1e-6)) ++bent;
    }
    EXPECT_LE(bent, trial % 5);
    EXPECT_NEAR(length, strand.TotalLength(), strand.TotalLength() * 3e-4);
  }
}

TEST_F(WoundReconstructTest, PolylinesAreNeverLongerThanTheHairAndReachItsLength) {
  const Strand strand = RandomStrand(6);
  double shortfall = 1e9;
  for (const size_t count : {2u, 17u, 257u, 4097u}) {
    const auto points = Sampled(strand, count);
    double length = 0;
    for (size_t i = 1; i < count; ++i) length += (points[i] - points[i - 1]).norm();
    EXPECT_LT(length, strand.TotalLength());
    EXPECT_LT(strand.TotalLength() - length, 0.9 * shortfall) << count;
    shortfall = strand.TotalLength() - length;
  }
  EXPECT_LT(shortfall, 1e-4 * strand.TotalLength());
}

TEST_F(WoundReconstructTest, MovingTheRootMovesEveryPointRigidly) {
  const Strand strand = RandomStrand(6);
  const math::Pose head{RandomVector(), math::FromRotationVector(RandomVector())};
  Strand moved = strand;
  moved.root = head * strand.root;
  const auto local = Sampled(strand, 20), world = Sampled(moved, 20);
  for (size_t i = 0; i < 20; ++i) EXPECT_LT((world[i] - head * local[i]).norm(), 1e-14) << i;
}

TEST_F(WoundReconstructTest, SinglePrecisionIsTheDoubleResultRounded) {
  const Strand strand = RandomStrand(5);
  const auto expected = Sampled(strand, 16);
  std::vector<Eigen::Vector3f> rounded(16);
  SampleWoundPoints(strand.root, strand.lengths, strand.natural, strand.x, std::span(rounded));
  for (size_t i = 0; i < 16; ++i) EXPECT_EQ(rounded[i], expected[i].cast<float>()) << i;
}

TEST_F(WoundReconstructTest, RefusesWhatIsNoCoil) {
  Strand strand = RandomStrand(3);
  strand.natural[1] = {50, 0, 0};
  EXPECT_THROW(Sampled(strand, 4), base::CheckFailure);
  strand = RandomStrand(3);
  strand.x.pop_back();
  EXPECT_THROW(Sampled(strand, 4), base::CheckFailure);
}

}  // namespace
}  // namespace mane::wire
