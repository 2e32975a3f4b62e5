// Laws of hairs on their guides:
//   numbers      those of the Python client, which shares no code
//   inverse      OffsetOf gives back what AssembleHair made, on any guide
//   guide        an offset of 0 lies on the guide: at its samples, and on an arc between them to
//   the
//                order of the spline
//   rigid        moving points and root frame moves hairs with them
//   stiff        |h - p| = |o| however the guide bends; nothing turns about a straight guide
//   transport    on a plane arc the carried frame turns with the tangent only; on a helix it turns
//                about the tangent by minus the torsion, which makes the angle known
//   degenerate   coincident points, a fold, two points: unit frames, no NaN

#include "wire/assemble_hair.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace mane::wire {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

constexpr float kUnit = 1e-6f;

struct Guide {
  std::vector<Vector3f> points;
  Quaternionf root = Quaternionf::Identity();
  std::vector<Quaternionf> frames = {};

  CarriedGuide Carried() {
    frames.resize(points.size());
    CarryFrames(root, points, frames);
    return {points, frames};
  }
};

std::vector<Vector3f> Assembled(Guide& guide, const std::vector<HairPlace>& places) {
  std::vector<Vector3f> out(places.size());
  AssembleHair(guide.Carried(), places, kUnit, out);
  return out;
}

// A circular helix of `turns` about x with the pitch angle whose tangent has `cosine` along x; its
// root frame has n0 along its tangent and n1 against its normal.
Guide Helix(int n, float length, float turns, float cosine) {
  const float sine = std::sqrt(1 - cosine * cosine);
  const float rate = 2 * std::numbers::pi_v<float> * turns / length, r = sine / rate;
  Guide guide;
  for (int k = 0; k < n; ++k) {
    const float s = length * static_cast<float>(k) / static_cast<float>(n - 1);
    guide.points.emplace_back(cosine * s, r * std::cos(rate * s), r * std::sin(rate * s));
  }
  Eigen::Matrix3f axes;
  axes.col(0) = Vector3f(cosine, 0, sine);
  axes.col(1) = Vector3f::UnitY();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  guide.root = Quaternionf(axes);
  return guide;
}

Guide Wild(std::mt19937& random, int n) {
  std::normal_distribution<float> normal;
  Guide guide;
  guide.root =
      Quaternionf(normal(random), normal(random), normal(random), normal(random)).normalized();
  Vector3f p = 0.1f * Vector3f(normal(random), normal(random), normal(random));
  for (int k = 0; k < n; ++k) {
    guide.points.push_back(p);
    p += 0.01f * Vector3f(normal(random), normal(random), normal(random));
  }
  return guide;
}

std::vector<HairPlace> Places(std::mt19937& random, int count) {
  std::uniform_int_distribution<int> part(0, kTipPart), offset(-32768, 32767);
  const auto next = [&] { return static_cast<int16_t>(offset(random)); };
  std::vector<HairPlace> places = {{0, {1, 2, 3}}, {kTipPart, {-32768, 32767, 0}}};
  for (int i = 0; i < count; ++i) {
    places.push_back({static_cast<uint16_t>(part(random)), {next(), next(), next()}});
  }
  return places;
}

Vector3f OffsetAt(const HairPlace& place) {
  return kUnit * Vector3f(place.offset[0], place.offset[1], place.offset[2]);
}

TEST(AssembleHairTest, NumbersAreThoseOfThePythonClient) {
  // clients_py/tests/test_hairs.py holds the same.
  Guide guide;
  for (const float k : {0.f, 1.f, 2.f, 3.f, 4.f, 5.f}) {
    guide.points.emplace_back(0.01f * k, 0.002f * k * k, 0.0005f * k * k * k - 0.003f * k);
  }
  guide.root = Quaternionf(0.9f, 0.1f, -0.2f, 0.3f).normalized();
  const std::vector<Vector3f> out = Assembled(guide, {{0, {0, 0, 0}},
                                                      {6554, {1000, -2000, 3000}},
                                                      {30000, {-32768, 0, 32767}},
                                                      {50001, {5, 20000, -7}},
                                                      {65535, {100, -100, 10000}}});
  const Vector3f expected[] = {{0, 0, 0},
                               {0.00657556f, -0.00140369f, 0.00118462f},
                               {-0.0050273f, -0.02163451f, 0.01752796f},
                               {0.02125573f, 0.03980272f, 0.01673346f},
                               {0.04583381f, 0.0428588f, 0.05312727f}};
  for (size_t i = 0; i < out.size(); ++i) EXPECT_LT((out[i] - expected[i]).norm(), 5e-8f) << i;
}

TEST(AssembleHairTest, OffsetOfIsTheInverseOnAnyGuide) {
  std::mt19937 random(1);
  for (const int n : {2, 3, 4, 16, 256}) {
    Guide guide = Wild(random, n);
    const CarriedGuide carried = guide.Carried();
    const std::vector<HairPlace> places = Places(random, 200);
    const std::vector<Vector3f> out = Assembled(guide, places);
    for (size_t i = 0; i < places.size(); ++i) {
      const Vector3f offset = OffsetOf(carried, places[i].part, out[i]);
      EXPECT_LT((offset - OffsetAt(places[i])).norm(), 2e-6f) << n;  // Roundings.
    }
  }
}

TEST(AssembleHairTest, OffsetsOfZeroLieOnTheGuide) {
  std::mt19937 random(2);
  Guide guide = Wild(random, 16);
  for (int k = 0; k < 16; ++k) {
    const HairPlace place{static_cast<uint16_t>(k * kTipPart / 15), {}};
    EXPECT_LT((Assembled(guide, {place})[0] - guide.points[k]).norm(), 1e-6f);
  }
  // Between samples of an arc of radius R, h apart: inside, the tangents are short by h^3 / 6 R^2,
  // which makes h^4 / 48 R^3, and the cubic is off by h^4 / 384 R^3; at the ends h^3 / R^2.
  const float R = 0.05f, length = 0.1f;
  for (const int n : {9, 17, 33}) {
    Guide arc;
    for (int k = 0; k < n; ++k) {
      const float angle = length / R * static_cast<float>(k) / static_cast<float>(n - 1);
      arc.points.emplace_back(R * std::sin(angle), R * (1 - std::cos(angle)), 0);
    }
    const float h = length / static_cast<float>(n - 1);
    for (int part = 0; part <= kTipPart; part += 257) {
      const Vector3f p = Assembled(arc, {{static_cast<uint16_t>(part), {}}})[0];
      const float x = static_cast<float>(part) / kTipPart * length / h;
      const bool inside = x > 1 && x < static_cast<float>(n - 2);
      const float bound =
          inside ? 0.025f * std::pow(h, 4.f) / std::pow(R, 3.f) : 0.1f * std::pow(h, 3.f) / (R * R);
      EXPECT_NEAR((p - Vector3f(0, R, 0)).norm(), R, bound + 2e-8f) << n << " " << part;
    }
  }
}

TEST(AssembleHairTest, ARigidMotionMovesHairsRigidly) {
  std::mt19937 random(3);
  for (int trial = 0; trial < 20; ++trial) {
    Guide guide = Wild(random, 16), moved = guide;
    const Guide motion = Wild(random, 2);
    moved.root = motion.root * guide.root;
    for (Vector3f& p : moved.points) p = motion.root * p + motion.points[0];
    const std::vector<HairPlace> places = Places(random, 50);
    const std::vector<Vector3f> here = Assembled(guide, places), there = Assembled(moved, places);
    for (size_t i = 0; i < places.size(); ++i) {
      EXPECT_LT((there[i] - (motion.root * here[i] + motion.points[0])).norm(), 5e-6f);
    }
  }
}

TEST(AssembleHairTest, HairsKeepTheirDistanceFromAGuideThatBends) {
  std::mt19937 random(4);
  const std::vector<HairPlace> places = Places(random, 100);
  std::vector<HairPlace> centres = places;
  for (HairPlace& place : centres) place.offset = {};
  for (const float turns : {0.1f, 0.5f, 2.f, 5.f}) {
    Guide guide = Helix(48, 0.3f, turns, 0.6f);
    const std::vector<Vector3f> out = Assembled(guide, places), p = Assembled(guide, centres);
    for (size_t i = 0; i < places.size(); ++i) {
      EXPECT_NEAR((out[i] - p[i]).norm(), OffsetAt(places[i]).norm(), 1e-7f) << turns;
    }
  }
}

TEST(AssembleHairTest, TheCarriedFrameTurnsNoMoreThanItMust) {
  // A straight guide: the root frame everywhere. A plane arc: the normal of its plane stays.
  Guide guide{{{0, 0, 0}, {0.1f, 0, 0}, {0.2f, 0, 0}, {0.3f, 0, 0}}};
  guide.root = Quaternionf(Eigen::AngleAxisf(0.7f, Vector3f::UnitX()));
  for (const Quaternionf& frame : guide.Carried().frames) {
    EXPECT_TRUE(frame.isApprox(guide.root, 1e-6f));
  }
  Guide arc = Helix(64, 0.3f, 1, 0);
  for (const Quaternionf& frame : arc.Carried().frames) {
    EXPECT_TRUE((frame * Vector3f::UnitZ()).isApprox(-Vector3f::UnitX(), 1e-5f));
  }
  // On a helix the carried frame turns about the tangent by minus the torsion's integral against
  // the normal: -2 pi turns cosine. Second order in the spacing.
  const float turns = 1.3f, cosine = 0.5f;
  float errors[2];
  for (const int fine : {0, 1}) {
    const int n = fine ? 97 : 49;
    Guide helix = Helix(n, 0.3f, turns, cosine);
    const Quaternionf tip = helix.Carried().frames.back();
    const float end = 2 * std::numbers::pi_v<float> * turns;
    const Vector3f normal(0, std::cos(end), std::sin(end));  // As n1 is at the root.
    const Vector3f seen = tip.conjugate() * normal;
    const float angle = std::atan2(seen.z(), seen.y()), expected = -end * cosine;
    errors[fine] = std::abs(std::remainder(
        std::abs(angle) - std::abs(std::remainder(expected, end / turns)), end / turns));
  }
  EXPECT_LT(errors[0], 0.01f);
  EXPECT_LT(errors[1], errors[0] / 3);
}

TEST(AssembleHairTest, NothingIsUndefined) {
  const Vector3f a(0.1f, 0, 0), b(0.2f, 0.1f, 0);
  for (const std::vector<Vector3f>& points :
       {std::vector{a, a}, {a, a, a}, {a, b}, {b, a, b, a, b}, {a, b, b, b, a}, {a, b, a}}) {
    for (const Quaternionf& root :
         {Quaternionf(1, 0, 0, 0), Quaternionf(0, 0, 0, 1), Quaternionf(0, 0, 1, 0)}) {
      Guide guide{points, root};
      for (const Quaternionf& frame : guide.Carried().frames) {
        EXPECT_NEAR(frame.norm(), 1, 1e-6f);
      }
      std::mt19937 random(5);
      for (const Vector3f& h : Assembled(guide, Places(random, 20))) EXPECT_TRUE(h.allFinite());
    }
  }
  // A guide that turns back at its root has no direction to turn to: the frame stays.
  Guide fold{{{0, 0, 0}, {-0.1f, 0, 0}}};
  EXPECT_TRUE(fold.Carried().frames[1].isApprox(fold.root));
}

}  // namespace
}  // namespace mane::wire
