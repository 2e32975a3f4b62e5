// Laws of an animated head:
//   workers     any number of them gives the same bits
//   pure        a copy of the state replays the same bits; other heads do not matter
//   teleport    shapes and speeds stay as they are, seen from the head
//   rest        a head that stands still stays at rest; Reset brings it back there
//   steps       one movement of k substeps is k movements of one; long ones are cut up
//   gauge       where the world's origin and its horizontal axes point does not matter

#include "head/head.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "head/frame.h"
#include "head/sample_groom.h"
#include "rod/scheme.h"
#include "wire/frame_codec.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

math::Pose Shaken(double t) {
  return {{0.1 * std::sin(8 * t), 0.02 * std::cos(11 * t), 0.03 * t},
          math::FromRotationVector({0.2 * std::sin(5 * t), 0.8 * std::sin(9 * t), 0})};
}

// Half a second of shaking at 60 Hz.
HeadState Shake(const groom::Groom& groom, HeadState state, exec::WorkerPool& pool) {
  for (int i = 1; i <= 30; ++i) {
    Advance(groom, {Shaken(i / 60.0), 1 / 60.0, 1}, {}, &state, pool);
  }
  return state;
}

bool SameBits(const HeadState& a, const HeadState& b) {
  return a.guides.size() == b.guides.size() &&
         std::memcmp(a.guides.data(), b.guides.data(), a.guides.size() * sizeof(a.guides[0])) == 0;
}

// Velocities of all guides at Gauss points, world [m/s].
std::vector<Vector3d> Velocities(const groom::Groom& groom, const HeadState& state) {
  std::vector<Vector3d> all;
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    const size_t N = groom.guides[guide].strand.elements();
    std::vector<Vector3d> theta(N), rate(N),
        velocity(N * (groom.guides[guide].wound ? rod::kBeads : rod::kGaussPoints));
    std::vector<rod::Vector4d> x(N), dx(N);
    if (groom.guides[guide].wound) {
      groom.batch.GetStrand(guide, state.guides, rod::WoundState{x, dx, velocity});
    } else {
      groom.batch.GetStrand(guide, state.guides, rod::StrandState{theta, rate, velocity});
    }
    all.insert(all.end(), velocity.begin(), velocity.end());
  }
  return all;
}

double Farthest(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(a[i] - b[i]));
  return worst;
}

TEST(HeadTest, AnyNumberOfWorkersGivesTheSameBits) {
  const auto groom = SampleGroom(41, 5);
  exec::WorkerPool one(1);
  const HeadState expected = Shake(*groom, AtRest(*groom, Shaken(0)), one);
  for (int workers : {2, 3, 8}) {
    exec::WorkerPool many(workers);
    EXPECT_TRUE(SameBits(Shake(*groom, AtRest(*groom, Shaken(0)), many), expected)) << workers;
  }
}

TEST(HeadTest, ACopyOfTheStateReplaysWhateverRunsBeside) {
  const auto groom = SampleGroom(9, 5), other = SampleGroom(17, 3);
  exec::WorkerPool pool(2);
  const HeadState start = Shake(*groom, AtRest(*groom, Shaken(0)), pool);
  const HeadState expected = Shake(*groom, start, pool);
  Shake(*other, AtRest(*other, {}), pool);
  EXPECT_TRUE(SameBits(Shake(*groom, start, pool), expected));
}

TEST(HeadTest, TeleportKeepsShapesAndTurnsSpeedsWithTheHead) {
  const auto groom = SampleGroom(7, 4);
  exec::WorkerPool pool(1);
  const HeadState before = Shake(*groom, AtRest(*groom, Shaken(0)), pool);
  const math::Pose target{{3, -1, 2}, math::FromRotationVector({1, 2, -0.5})};
  HeadState after = before;
  Teleport(*groom, target, &after);
  EXPECT_EQ(Coordinates(*groom, after), Coordinates(*groom, before));
  EXPECT_EQ(after.pose.p, target.p);
  const auto a = Velocities(*groom, before), b = Velocities(*groom, after);
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    // Relative to each head; a rotation costs a few roundings.
    const Vector3d difference = before.pose.q.conjugate() * a[i] - after.pose.q.conjugate() * b[i];
    EXPECT_LT(difference.norm(), 1e-6 * (1 + a[i].norm()));
  }
}

TEST(HeadTest, RestStaysAtRestAndResetBringsItBack) {
  const auto groom = SampleGroom(8, 5);
  exec::WorkerPool pool(1);
  const HeadState rest = AtRest(*groom, {});
  HeadState state = rest;
  for (int i = 0; i < 120; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
  // Angles of a few radians in float32, two seconds of roundings.
  EXPECT_LT(Farthest(Coordinates(*groom, state), Coordinates(*groom, rest)), 1e-5);

  HeadState shaken = Shake(*groom, rest, pool);
  EXPECT_GT(Farthest(Coordinates(*groom, shaken), Coordinates(*groom, rest)), 0.01);
  Reset(*groom, &shaken);
  EXPECT_TRUE(SameBits(shaken, rest));
}

TEST(HeadTest, SubstepsAreShorterMovements) {
  const auto groom = SampleGroom(6, 5);
  exec::WorkerPool pool(1);
  const math::Pose from = Shaken(0), to = Shaken(0.03);
  HeadState once = AtRest(*groom, from), twice = once;
  Advance(*groom, {to, 0.03, 2}, {}, &once, pool);
  Advance(*groom, {math::Interpolate(from, to, 0.5), 0.015, 1}, {}, &twice, pool);
  Advance(*groom, {to, 0.015, 1}, {}, &twice, pool);
  EXPECT_LT(Farthest(Coordinates(*groom, once), Coordinates(*groom, twice)), 1e-12);
}

TEST(HeadTest, LongMovementsAreCutIntoStepsOfASixtiethOfASecond) {
  const auto groom = SampleGroom(6, 5);
  exec::WorkerPool pool(1);
  const math::Pose from = Shaken(0), to = Shaken(0.5);
  HeadState whole = AtRest(*groom, from), cut = whole;
  Advance(*groom, {to, 0.3, 1}, {}, &whole, pool);
  Advance(*groom, {to, 0.3, 54}, {}, &cut, pool);
  // 0.3 s is eighteen longest steps, and asking for three times as many makes them shorter.
  HeadState thrice = AtRest(*groom, from);
  for (int i = 1; i <= 3; ++i) {
    Advance(*groom, {math::Interpolate(from, to, i / 3.0), 0.1, 1}, {}, &thrice, pool);
  }
  EXPECT_LT(Farthest(Coordinates(*groom, whole), Coordinates(*groom, thrice)), 1e-12);
  EXPECT_GT(Farthest(Coordinates(*groom, cut), Coordinates(*groom, thrice)), 1e-6);
}

TEST(HeadTest, AJumpFasterThanAnyHeadIsATeleport) {
  const auto groom = SampleGroom(16, 5);
  exec::WorkerPool pool(1);
  const HeadState rest = AtRest(*groom, {});
  HeadState jumped = rest, still = rest;
  const math::Pose far{{1e6, -1e6, 1e5}, Eigen::Quaterniond::Identity()};
  EXPECT_EQ(Advance(*groom, {far, 1 / 60.0, 1}, {}, &jumped, pool).repaired_guides, 0);
  Advance(*groom, {{}, 1 / 60.0, 1}, {}, &still, pool);
  EXPECT_EQ(jumped.pose.p, far.p);
  EXPECT_LT(Farthest(Coordinates(*groom, jumped), Coordinates(*groom, still)), 1e-6);
}

TEST(HeadTest, NeitherOriginNorHeadingOfTheWorldMatters) {
  const auto groom = SampleGroom(6, 5);
  exec::WorkerPool pool(1);
  const math::Pose gauge{{2, 1, -3}, math::FromRotationVector({0, 1.1, 0})};
  HeadState a = AtRest(*groom, Shaken(0)), b = AtRest(*groom, gauge * Shaken(0));
  for (int i = 1; i <= 30; ++i) {
    const math::Pose pose = Shaken(i / 60.0);
    Advance(*groom, {pose, 1 / 60.0, 1}, {}, &a, pool);
    Advance(*groom, {gauge * pose, 1 / 60.0, 1}, {}, &b, pool);
  }
  // Roundings of float32, amplified by half a second of shaking.
  EXPECT_LT(Farthest(Coordinates(*groom, a), Coordinates(*groom, b)), 1e-4);
}

TEST(HeadTest, WindBlowsHairAlong) {
  const auto groom = SampleGroom(8, 5);
  exec::WorkerPool pool(1);
  Environment wind;
  wind.wind = {0, 0, 5};
  const auto mean_tip = [&](const Environment& environment) {
    HeadState state = AtRest(*groom, {});
    for (int i = 0; i < 120; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, environment, &state, pool);
    const View view{FrameFormat::kPositionsFloat32, Space::kHead, 2};
    const std::string data = EncodeFrame(*groom, state, view, pool);
    Vector3d mean = Vector3d::Zero();
    for (int i = 0; i < groom->guide_count(); ++i) {
      std::vector<Eigen::Vector3f> points(2);
      wire::DecodePositions(std::as_bytes(std::span(data)).subspan(i * 24, 24), points);
      mean += points[1].cast<double>() / groom->guide_count();
    }
    return mean;
  };
  EXPECT_GT(mean_tip(wind).z(), mean_tip({}).z() + 0.01);
}

}  // namespace
}  // namespace mane::head
