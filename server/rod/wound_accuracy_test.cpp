// A wound strand of N = 5 or 10 against a plain Super-Helix that resolves the coil:
//   hair     the natural shape is the plain helix; the hair is as long as its arc length
//   rest     vertical extent within 2 % and tip within 5 % of the length, axis along and across
//            gravity, at several rolls about it
//   varied   the same where the natural curvature varies along the hair
//   motion   the tip of a shaken strand follows the resolved one's

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "rod/chain.h"
#include "rod/test_wound.h"
#include "rod/wound_shape.h"
#include "rod/wound_statics.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;
using fixtures::Hair;
using fixtures::Random;
using fixtures::WoundOwned;

const Vector3d kGravity(0, -9.81, 0);

const Hair& Curly() { return fixtures::AppendixB()[2]; }
const Hair& Fuzzy() { return fixtures::AppendixB()[3]; }

// Root frame that puts the natural axis along or across gravity, turned by `roll` about it.
math::Pose Rolled(const Hair& hair, bool down, double roll) {
  const math::Pose clamp = fixtures::AxisClamp(fixtures::MakeStrand(hair, 0.1, 1), down);
  const Vector3d axis = down ? Vector3d(0, -1, 0) : Vector3d(1, 0, 0);
  return {clamp.p, math::FromRotationVector(roll * axis) * clamp.q};
}

// A plain strand with `per_turn` elements a turn.
Strand Resolved(const Hair& hair, double length, int per_turn) {
  const double turns = NaturalTurns(fixtures::MakeStrand(hair, length, 1));
  return fixtures::MakeStrand(hair, length, static_cast<int>(std::ceil(per_turn * turns)));
}

// A plain strand of the same natural shape, each element in equal parts, `per_turn` a turn.
Strand Refined(const Strand& strand, int per_turn) {
  Strand fine = strand;
  fine.length.clear();
  fine.natural.clear();
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const double turns = strand.natural[Q].norm() * strand.length[Q] / (2 * M_PI);
    const int parts = static_cast<int>(std::ceil(per_turn * turns));
    fine.length.insert(fine.length.end(), parts, strand.length[Q] / parts);
    fine.natural.insert(fine.natural.end(), parts, strand.natural[Q]);
  }
  return fine;
}

// For the table of coil.md: --gtest_output=json shows the last value of a key.
void Record(const Hair& hair, double length, int N, const char* what, double value) {
  testing::Test::RecordProperty(
      hair.name + std::to_string(length).substr(0, 3) + "_" + std::to_string(N) + "_" + what,
      std::to_string(100 * value) + " %");
}

TEST(WoundAccuracyTest, NaturalShapeIsThePlainHelix) {
  Random random(8);
  for (const Hair& hair : {Curly(), Fuzzy()}) {
    const WoundStrand wound = fixtures::MakeGraded(hair, 0.2, 10);
    const math::Pose clamp = random.Pose();
    const fixtures::State plain(wound.strand);
    const WoundOwned state(wound);
    const std::vector<WoundFrame> frames = WoundFrames(wound, clamp, state.x);
    for (double s = 0; s <= 0.2; s += 0.003) {
      const Vector3d r = PointAt(wound.strand, clamp, plain.theta, Locate(wound.strand, s)).r;
      EXPECT_LT((PointOnHair(wound, frames, state.x, s) - r).norm(), 1e-12);
    }
    // The axis stays in the middle of the hair.
    const WoundFrame& tip = frames.back();
    EXPECT_NEAR((tip.hair - tip.axis).norm(), wound.coil.back().radius, 1e-12);
  }
}

TEST(WoundAccuracyTest, HairIsAsLongAsItsArcLength) {
  Random random(9);
  for (const double off : {0.3, 2.0, 8.0}) {  // Up to where the axis turns as fast as the coil.
    const WoundStrand wound = fixtures::AnyWound(random, 6, 0.2, 7);
    const WoundOwned state(wound, random, off, 0, 0);
    const math::Pose clamp = random.Pose();
    const std::vector<WoundFrame> frames = WoundFrames(wound, clamp, state.x);
    // A polyline through all joints, where the hair has kinks: of second order.
    const auto length = [&](int points) {
      double sum = 0, left = 0;
      Vector3d previous = clamp.p;
      for (const double l : wound.strand.length) {
        for (int i = 1; i <= points; ++i) {
          const Vector3d r = PointOnHair(wound, frames, state.x, left + l * i / points);
          sum += (r - previous).norm();
          previous = r;
        }
        left += l;
      }
      return sum;
    };
    const double L = wound.strand.TotalLength(), coarse = length(500), fine = length(1000);
    EXPECT_LT(fine, L);
    EXPECT_NEAR((4 * fine - coarse) / 3, L, 1e-8 * L) << off;
    for (int Q = 1; Q <= 6; ++Q) {
      double s = 0;
      for (int P = 0; P < Q; ++P) s += wound.strand.length[P];
      EXPECT_LT((PointOnHair(wound, frames, state.x, s) - frames[Q].hair).norm(), 1e-12);
      EXPECT_LT((PointOnHair(wound, frames, state.x, s + 1e-12) - frames[Q].hair).norm(), 1e-11);
    }
  }
}

// A hair's vertical extent and tip, in units of its length.
struct Shape {
  double extent;
  Vector3d tip;
};

template <class Point>
Shape ShapeOf(double L, const Point& point) {
  constexpr int kPoints = 3000;
  double low = 0, high = 0;
  for (int i = 0; i <= kPoints; ++i) {
    const double y = point(L * i / kPoints).y();
    low = std::min(low, y);
    high = std::max(high, y);
  }
  return {(high - low) / L, point(L) / L};
}

// The weight in parts, so that the equilibrium is of the branch that grows from the natural shape.
constexpr double kParts[] = {0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0};

Shape PlainShape(const Strand& strand, const math::Pose& clamp) {
  std::vector<Vector3d> theta = fixtures::State(strand).theta;
  StaticsReport report;
  for (const double part : kParts) report = SolveRestShape(strand, clamp, part * kGravity, theta);
  EXPECT_LT(report.residual, 1e-6) << report.iterations;
  const std::vector<ElementFrame> frames = ElementFrames(strand, clamp, theta);
  return ShapeOf(strand.TotalLength(), [&](double s) -> Vector3d {
    const auto [Q, fraction] = Locate(strand, s);
    const ElementPoint point = PointOnElement(theta[Q], fraction);
    return frames[Q].r + strand.length[Q] * (frames[Q].R * point.p);
  });
}

// Of second order in the elements' lengths: extrapolated from two resolutions.
Shape ConvergedShape(const Hair& hair, double length, const math::Pose& clamp, int per_turn) {
  const Shape coarse = PlainShape(Resolved(hair, length, per_turn / 2), clamp);
  const Shape fine = PlainShape(Resolved(hair, length, per_turn), clamp);
  EXPECT_LT((fine.tip - coarse.tip).norm(), 0.015);  // Close to convergence.
  return {(4 * fine.extent - coarse.extent) / 3, (4 * fine.tip - coarse.tip) / 3};
}

Shape WoundShape(const WoundStrand& wound, const math::Pose& clamp) {
  std::vector<Vector4d> x = wound.natural;
  StaticsReport report;
  for (const double part : kParts) report = SolveRestShape(wound, clamp, part * kGravity, x);
  EXPECT_TRUE(report.converged) << report.residual;
  const std::vector<WoundFrame> frames = WoundFrames(wound, clamp, x);
  return ShapeOf(wound.strand.TotalLength(),
                 [&](double s) { return PointOnHair(wound, frames, x, s); });
}

void ExpectAccurate(const Hair& hair, double length, const math::Pose& clamp,
                    const Shape& converged) {
  for (const int N : {5, 10}) {
    SCOPED_TRACE(testing::Message() << hair.name << " L=" << length << " N=" << N);
    const Shape mine = WoundShape(fixtures::MakeGraded(hair, length, N), clamp);
    const double extent = std::abs(mine.extent - converged.extent);
    const double tip = (mine.tip - converged.tip).norm();
    Record(hair, length, N, "extent", extent);
    Record(hair, length, N, "tip", tip);
    EXPECT_LT(extent, 0.02);
    EXPECT_LT(tip, 0.05);
  }
}

TEST(WoundAccuracyTest, CurlyRestsAsTheResolvedStrand) {
  for (const double length : {0.2, 0.3}) {
    for (const bool down : {true, false}) {
      for (int roll = 0; roll < 4; ++roll) {
        SCOPED_TRACE(testing::Message() << (down ? "along" : "across") << " roll " << roll);
        const math::Pose clamp = Rolled(Curly(), down, roll * M_PI / 2);
        ExpectAccurate(Curly(), length, clamp, ConvergedShape(Curly(), length, clamp, 20));
      }
    }
  }
}

TEST(WoundAccuracyTest, FuzzyRestsAsTheResolvedStrand) {
  for (const bool down : {true, false}) {
    SCOPED_TRACE(down ? "along" : "across");
    const math::Pose clamp = Rolled(Fuzzy(), down, 0);
    for (const double length : {0.1, 0.2, 0.3}) {
      ExpectAccurate(Fuzzy(), length, clamp, ConvergedShape(Fuzzy(), length, clamp, 12));
    }
  }
}

// Curl that varies along the hair (C12): natural shape and rest, in six draws.
TEST(WoundAccuracyTest, VariedCurlRestsAsTheResolvedStrand) {
  struct Case {
    const Hair& hair;
    double length;
    int per_turn;
  };
  for (const Case& c : {Case{Curly(), 0.2, 20}, Case{Curly(), 0.3, 20}, Case{Fuzzy(), 0.1, 12},
                        Case{Fuzzy(), 0.2, 12}, Case{Fuzzy(), 0.3, 12}}) {
    for (const int N : {5, 10}) {
      for (const int percent : {5, 10}) {
        SCOPED_TRACE(testing::Message() << c.hair.name << c.length << " N=" << N << " " << percent);
        Random random(61);
        double natural = 0, extent = 0, tip = 0;
        for (int draw = 0; draw < 6; ++draw) {
          const Strand strand = fixtures::Varied(fixtures::MakeGraded(c.hair, c.length, N).strand,
                                                 0.01 * percent, random);
          EXPECT_TRUE(IsWound(strand));
          const WoundStrand wound = MakeWound(strand);
          const math::Pose clamp = Rolled(c.hair, false, draw * M_PI / 3);
          const Vector3d exact =
              ElementFrames(strand, clamp, fixtures::State(strand).theta).back().r;
          const Vector3d mine = WoundFrames(wound, clamp, wound.natural).back().hair;
          natural = std::max(natural, (mine - exact).norm() / c.length);
          const Shape rest = WoundShape(wound, clamp);
          const Shape coarse = PlainShape(Refined(strand, c.per_turn / 2), clamp);
          const Shape fine = PlainShape(Refined(strand, c.per_turn), clamp);
          EXPECT_LT((fine.tip - coarse.tip).norm(), 0.015);
          extent = std::max(extent, std::abs(rest.extent - (4 * fine.extent - coarse.extent) / 3));
          tip = std::max(tip, (rest.tip - (4 * fine.tip - coarse.tip) / 3).norm());
        }
        const std::string what = "varied" + std::to_string(percent) + "_";
        Record(c.hair, c.length, N, (what + "natural").c_str(), natural);
        Record(c.hair, c.length, N, (what + "extent").c_str(), extent);
        Record(c.hair, c.length, N, (what + "tip").c_str(), tip);
        EXPECT_LT(natural, 0.01);
        EXPECT_LT(extent, 0.02);
        EXPECT_LT(tip, 0.05);
      }
    }
  }
}

// Tips along a shake of the clamp, in units of the length, from the natural shape's equilibrium.
using Tips = std::vector<Vector3d>;

template <class Advance>
Tips Shake(double L, const math::Pose& start, double seconds, const Advance& advance) {
  constexpr double dt = 1.0 / 120;
  const auto pose = [&](double t) {
    math::Pose clamp = start;
    clamp.p += 0.03 * Vector3d(std::sin(2 * M_PI * 1.3 * t), std::sin(2 * M_PI * 0.9 * t),
                               std::sin(2 * M_PI * 1.9 * t));
    return clamp;
  };
  Tips tips;
  for (int i = 0; i * dt < seconds; ++i) {
    tips.push_back(advance(ClampMotion{pose(i * dt), pose((i + 1) * dt), dt}) / L);
  }
  return tips;
}

Tips ShakePlain(const Strand& strand, const math::Pose& clamp, double seconds) {
  fixtures::State state(strand);
  for (const double part : kParts) {
    (void)SolveRestShape(strand, clamp, part * kGravity, state.theta);
  }
  StepScratch scratch;
  return Shake(strand.TotalLength(), clamp, seconds, [&](const ClampMotion& motion) -> Vector3d {
    EXPECT_TRUE(Step(strand, motion, {}, state.View(), scratch));
    return ElementFrames(strand, motion.end, state.theta).back().r;
  });
}

Tips ShakeWound(const WoundStrand& wound, const math::Pose& clamp, double seconds) {
  WoundOwned state(wound);
  for (const double part : kParts) (void)SolveRestShape(wound, clamp, part * kGravity, state.x);
  WoundScratch scratch;
  const double L = wound.strand.TotalLength();
  return Shake(L, clamp, seconds, [&](const ClampMotion& motion) -> Vector3d {
    EXPECT_TRUE(Step(wound, motion, {}, state.View(), scratch));
    return WoundFrames(wound, motion.end, state.x).back().hair;
  });
}

double Rms(const Tips& a, const Tips& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / a.size());
}

TEST(WoundAccuracyTest, ShakenVariedHairFollowsTheResolvedStrand) {
  Random random(62);
  for (const Hair& hair : {Curly(), Fuzzy()}) {
    const double length = hair.name == "curly" ? 0.2 : 0.1;
    const math::Pose clamp = Rolled(hair, false, 0);
    for (const int N : {5, 10}) {
      const Strand strand =
          fixtures::Varied(fixtures::MakeGraded(hair, length, N).strand, 0.05, random);
      const Tips mine = ShakeWound(MakeWound(strand), clamp, 0.8);
      const Tips resolved = ShakePlain(Refined(strand, hair.name == "curly" ? 12 : 8), clamp, 0.8);
      Record(hair, length, N, "shaken_varied", Rms(mine, resolved));
      EXPECT_LT(Rms(mine, resolved), 0.04) << hair.name << N;
    }
  }
}

TEST(WoundAccuracyTest, ShakenHairFollowsTheResolvedStrand) {
  struct Case {
    const Hair& hair;
    double length, seconds;
    int per_turn;
  };
  for (const Case& c :
       {Case{Curly(), 0.2, 1.5, 12}, Case{Curly(), 0.3, 1.5, 12}, Case{Fuzzy(), 0.1, 0.8, 8}}) {
    SCOPED_TRACE(testing::Message() << c.hair.name << " L=" << c.length);
    const math::Pose clamp = Rolled(c.hair, false, 0);
    const Tips resolved = ShakePlain(Resolved(c.hair, c.length, c.per_turn), clamp, c.seconds);
    for (const int N : {5, 10}) {
      const Tips mine = ShakeWound(fixtures::MakeGraded(c.hair, c.length, N), clamp, c.seconds);
      Record(c.hair, c.length, N, "shaken", Rms(mine, resolved));
      EXPECT_LT(Rms(mine, resolved), 0.04) << N;
    }
    const Tips plain = ShakePlain(fixtures::MakeStrand(c.hair, c.length, 10), clamp, c.seconds);
    Record(c.hair, c.length, 10, "shaken_plain", Rms(plain, resolved));
    EXPECT_GT(Rms(plain, resolved), 0.06);  // What a plain strand of N = 10 does.
  }
}

}  // namespace
}  // namespace mane::rod
