// What [AUK92] shows of hair in motion, with its numbers: d = rho = 1, k = 18, dt = 0.1, on a head
// of 6 x 8 x 7.
//   Figure 10   a gust of wind that turns: what moves with the old wind goes on for frames, and
//               hair undulates
//   Figure 11   bangs pass through the forehead, unless the field is weaker there
//   Figure 12   fluctuating hair stays smooth where its joints are limited

#include <gtest/gtest.h>

#include <cmath>

#include "beam/motion.h"
#include "beam/test_motion.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::Angle;
using fixtures::Kernels;
using fixtures::Moving;
using fixtures::OwnHair;
using fixtures::Still;

constexpr int kSegments = 18;
constexpr double kDt = 0.1;
const Hull kHead{Vector3d::Zero(), {6, 8, 7}};

// Hair from the pore at these angles, straight out at first, whose segments bend down the more the
// larger `fall`.
OwnHair Hair(double zenith, double azimuth, double d, double fall) {
  OwnHair hair;
  hair.root = kHead.Point(zenith, azimuth);
  hair.segment_length = d;
  Vector3d e = kHead.Gradient(hair.root).normalized(), node = hair.root;
  for (int i = 0; i < kSegments; ++i) {
    e = (e - fall * Vector3d::UnitY()).normalized();
    hair.rest.push_back(e);
    node += d * e;
    EXPECT_GT(kHead.At(node), 0);
  }
  hair.response = PublishedResponse(d, 1, kSegments);
  hair.hold.assign(kSegments, 0.0);
  return hair;
}

// As published: nothing held, nothing divided, polar angles; segments near the pore feel a tenth.
MotionSettings Published() {
  MotionSettings settings;
  settings.equations = Equations::kPolar;
  settings.bounded = false;
  settings.clamped = false;
  settings.hull = kHead;
  settings.avoid_hull = false;
  settings.near = 4;
  settings.epsilon.assign(kSegments, 0.1F);
  return settings;
}

// The wind of Figure 10, which blows from the face; as [AUK92] has it, in our axes.
Vector3d Gust(int frame) { return frame < 16 ? Vector3d(0, 0, -200) : Vector3d(0, -250, -20); }

// Where a curve in the plane across X bends the other way: changes of sign of its turns.
int Inflections(const std::vector<Vector3d>& e) {
  int count = 0;
  double before = 0;
  for (size_t i = 1; i < e.size(); ++i) {
    const double turn = e[i - 1].cross(e[i]).x();
    if (std::abs(turn) < 1e-3) continue;
    count += turn * before < 0;
    before = turn;
  }
  return count;
}

TEST(MotionSceneTest, AGustOfWindUndulatesHair) {
  for (const Equations equations : {Equations::kPolar, Equations::kAcross}) {
    MotionSettings settings = Published();
    settings.equations = equations;
    std::vector<OwnHair> hairs;  // The back of the head.
    for (const double zenith : {0.9, 1.1, 1.3}) hairs.push_back(Hair(zenith, 3.14159265, 1, 0.35));
    Moving<double> moving(hairs, settings);
    std::vector<int> begun;
    for (int i = 0; i < 3; ++i) begun.push_back(Inflections(moving.Directions(i)));
    for (int frame = 1; frame <= 20; ++frame) {
      moving.Step(Kernels(), Still(Gust(frame), kDt));
      for (int i = 0; i < 3; ++i) {
        const auto e = moving.Directions(i), steps = moving.Steps(i);
        // Ends go on upward, against the new wind, while what is near the pore already falls.
        EXPECT_GT(steps.back().y(), 0) << frame;
        if (frame >= 17) {
          EXPECT_LT(steps[0].y(), 0) << frame;
        }
        // And ends move more than what is nearer to the pore.
        EXPECT_GT(steps.back().norm(), steps[kSegments / 2].norm());
        if (frame == 20) {
          EXPECT_GT(Inflections(e), begun[i]);
        }
      }
    }
    // The new wind wins.
    int frame = 21;
    while (frame < 60 && moving.Steps(1).back().y() > 0) {
      moving.Step(Kernels(), Still(Gust(frame), kDt));
      ++frame;
    }
    EXPECT_LT(frame, 60);
  }
}

TEST(MotionSceneTest, BangsStayOffTheForehead) {
  std::vector<OwnHair> bangs;
  for (const double zenith : {0.9, 1.0, 1.1}) {
    for (const double azimuth : {-0.3, -0.1, 0.1, 0.3}) {
      bangs.push_back(Hair(zenith, azimuth, 0.4, 0.2));
    }
  }
  // Nodes inside after ten frames of a wind toward the forehead.
  const auto inside = [&](const MotionSettings& settings) {
    Moving<double> moving(bangs, settings);
    for (int frame = 1; frame <= 10; ++frame) {
      moving.Step(Kernels(), Still({0, 0, -500}, kDt));
    }
    int count = 0;
    for (int i = 0; i < moving.count(); ++i) {
      for (const Vector3d& node : moving.Nodes(Kernels(), i)) count += kHead.At(node) < -1e-9;
    }
    return count;
  };
  const int all = static_cast<int>(bangs.size()) * kSegments;
  MotionSettings settings = Published();
  EXPECT_EQ(inside(settings), 0);
  settings.epsilon.assign(kSegments, 1);
  EXPECT_GT(inside(settings), all / 3);
  settings.avoid_hull = true;
  EXPECT_EQ(inside(settings), 0);
}

TEST(MotionSceneTest, FluctuatingHairStaysSmooth) {
  constexpr float kTurn = 0.26F;
  const auto sharpest = [&](bool limited) {
    MotionSettings settings = Published();
    settings.fluctuation = 0.25;
    settings.largest_turn.assign(kSegments, static_cast<float>(std::numbers::pi));
    for (int i = 8; limited && i < kSegments; ++i) settings.largest_turn[i] = kTurn;
    std::vector<OwnHair> hairs(16, Hair(1.1, 3, 0.5, 0.25));
    Moving<double> moving(hairs, settings);
    double largest = 0;
    for (int frame = 1; frame <= 30; ++frame) {
      MotionDrive drive = Still(Gust(frame) / 2, kDt);
      drive.frame = frame;
      moving.Step(Kernels(), drive);
      for (int i = 0; i < 16; ++i) {
        const auto e = moving.Directions(i);
        for (int s = 8; s < kSegments; ++s) largest = std::max(largest, Angle(e[s - 1], e[s]));
      }
    }
    return largest;
  };
  EXPECT_LE(sharpest(true), kTurn + 1e-6);
  EXPECT_GT(sharpest(false), 1.5 * kTurn);
}

}  // namespace
}  // namespace mane::beam
