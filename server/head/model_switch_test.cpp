// Laws of a head that changes its model:
//   still       the first frame after a change is the one before; so is the way back
//   moving      no frame after a change is farther from the last one than ordinary ones are
//   home        at rest, one way and back leads to the rest shape, rods' exactly
//   follow      rods whose beams are at rest get the coordinates at rest; those of beams that hang
//               elsewhere lead where these do
//   offsets     what is shown on fades to nothing, and makes no guide longer

#include "head/model_switch.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "head/beam_follow.h"
#include "head/shown.h"
#include "head/test_beams.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kPoints = 32;

TEST(ModelSwitchTest, AStillHeadsShapeStays) {
  exec::WorkerPool pool(1);
  for (const auto& groom : TestGrooms()) {
    HeadState state = AtRest(*groom, Shaken(1));
    const auto beams = MakeBeams(*groom, nullptr, {}, pool);
    auto last = Points(*groom, state, kPoints, pool);
    for (const auto& to : {beams, std::shared_ptr<const Beams>(), beams}) {
      SwitchModel(*groom, to, kPoints, &state, pool);
      EXPECT_LT(Farthest(Points(*groom, state, kPoints, pool), last), 1e-6);
      for (int i = 0; i < 5; ++i) Advance(*groom, {state.pose, 1 / 60.0, 1}, {}, &state, pool);
      last = Points(*groom, state, kPoints, pool);
    }
  }
}

TEST(ModelSwitchTest, AStillUprightHeadShowsNoJump) {
  exec::WorkerPool pool(1);
  for (const auto& groom : TestGrooms()) {
    HeadState state = AtRest(*groom, {});
    const auto start = Points(*groom, state, kPoints, pool);
    const auto beams = MakeBeams(*groom, nullptr, {}, pool);
    SwitchModel(*groom, beams, kPoints, &state, pool);
    Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
    // What lies between the nodes begins to go; hardly, in the first frame.
    const double first = Farthest(Points(*groom, state, kPoints, pool), start);
    for (int i = 1; i < 20; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
    const double gone = Farthest(Points(*groom, state, kPoints, pool), start);
    EXPECT_LT(first, 0.02 * gone + 1e-5);
    EXPECT_EQ(state.transition.points, 0);

    const auto shown = Points(*groom, state, kPoints, pool);
    SwitchModel(*groom, nullptr, kPoints, &state, pool);
    Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
    EXPECT_LT(Farthest(Points(*groom, state, kPoints, pool), shown), 0.02 * gone + 1e-4);
    for (int i = 1; i < 120; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
    EXPECT_LT(Farthest(Points(*groom, state, kPoints, pool), start), 2e-4);
  }
}

// How far points come from frame to frame of a shake, of hair that changes its model every so many
// frames, or never.
std::vector<double> Moves(const groom::Groom& groom, const BeamOptions& options, bool beam,
                          int period, exec::WorkerPool& pool) {
  const auto beams = MakeBeams(groom, nullptr, options, pool);
  HeadState state = AtRest(groom, Shaken(0));
  if (beam) StartBeams(beams, &state);
  std::vector<double> moves;
  auto last = Points(groom, state, kPoints, pool);
  for (int i = 0; i < 200; ++i) {
    if (period > 0 && i > 0 && i % period == 0) {
      SwitchModel(groom, state.beams.active ? nullptr : beams, kPoints, &state, pool);
      EXPECT_LT(Farthest(Points(groom, state, kPoints, pool), last), 1e-4) << i;
    }
    Shake(groom, 1, &state, pool);
    const auto now = Points(groom, state, kPoints, pool);
    ExpectLengths(groom, now, kPoints);
    moves.push_back(Farthest(now, last));
    last = now;
  }
  return moves;
}

TEST(ModelSwitchTest, AMovingHeadsHairDoesNotJump) {
  exec::WorkerPool pool(1);
  // As many segments as curls take, and fewer, longer than curls are wide, which tell less of how
  // these move.
  for (const int segments : {0, 16, 8}) {
    const double most = segments == 0 ? 1.5 : 2;
    BeamOptions options;
    options.segments = segments;
    for (const auto& groom : TestGrooms()) {
      SCOPED_TRACE(segments);
      const std::vector<double> rods = Moves(*groom, options, false, 0, pool),
                                beams = Moves(*groom, options, true, 0, pool),
                                changing = Moves(*groom, options, false, 40, pool);
      for (int i = 40; i < std::ssize(changing); ++i) {
        if (i % 40 > 15) continue;  // The transition is over.
        // What either does within a period of the shake.
        double ordinary = 0;
        for (int j = std::max(0, i - 40); j < std::min<int>(i + 40, std::ssize(rods)); ++j) {
          ordinary = std::max({ordinary, rods[j], beams[j]});
        }
        EXPECT_LT(changing[i], most * ordinary) << i;
        // The first frame goes on as the last ones did, or as hair of either model does there.
        if (i % 40 == 0) {
          EXPECT_LT(changing[i],
                    most * std::max({changing[i - 1], changing[i - 2], rods[i], beams[i]}))
              << i;
        }
      }
    }
  }
}

TEST(ModelSwitchTest, RodsOfBeamsAtRestAreAtRest) {
  exec::WorkerPool pool(1);
  for (const auto& groom : TestGrooms()) {
    const auto beams = MakeBeams(*groom, nullptr, {}, pool);
    for (int guide = 0; guide < groom->guide_count(); ++guide) {
      std::vector<double> coordinates(groom->guides[guide].coordinate_count());
      FollowBeam(*groom, *beams, guide, beams->rest_of(guide), coordinates);
      const auto rest = groom->rest_of(guide);
      for (size_t i = 0; i < rest.size(); ++i) EXPECT_NEAR(coordinates[i], rest[i], 2e-6);
    }
  }
}

TEST(ModelSwitchTest, RodsLeadWhereTheirBeamsDo) {
  exec::WorkerPool pool(1);
  const auto groom = SampleGroom(12, 8, SampleHair::kPlain);
  const auto beams = MakeBeams(*groom, nullptr, {}, pool);
  HeadState state = AtRest(*groom, {});
  for (int guide = 0; guide < groom->guide_count(); guide += 2) {  // Those that are straight.
    std::vector<Vector3d> directions(beams->rest_of(guide).begin(), beams->rest_of(guide).end());
    const int k = static_cast<int>(directions.size());
    // Bent aside more and more, half a turn at the tip.
    for (int i = 0; i < k; ++i) {
      const double angle = 3.0 * i / (k - 1);
      directions[i] = math::FromRotationVector({0, 0, angle}) * directions[i];
    }
    Vector3d tip = groom->guides[guide].root.p;
    for (const Vector3d& e : directions) tip += beams->segment_length[guide] * e;
    std::vector<double> coordinates(groom->guides[guide].coordinate_count());
    FollowBeam(*groom, *beams, guide, directions, coordinates);
    groom->batch.SetStill(guide, coordinates, state.guides);
    const auto points = Points(*groom, state, 2, pool);
    EXPECT_LT((points[2 * guide + 1].cast<double>() - tip).norm(),
              0.04 * groom->guides[guide].strand.TotalLength());
  }
}

TEST(ModelSwitchTest, HairThatMovesAsOneWithTheHeadGoesOnSo) {
  // Rates and speeds are handed over: hair carried along at rest relative to a head that moves
  // steadily is at rest after a change, either way.
  exec::WorkerPool pool(1);
  const auto groom = SampleGroom(12, 6);
  const auto beams = MakeBeams(*groom, nullptr, {}, pool);
  Environment air;  // Thick, and moving along.
  air.wind = {1, 0, 0};
  air.air_drag_scale = 20;
  HeadState state = AtRest(*groom, {});
  const auto move = [&](int frames) {
    for (int i = 0; i < frames; ++i) {
      math::Pose to = state.pose;
      to.p.x() += 1 / 60.0;
      Advance(*groom, {to, 1 / 60.0, 1}, air, &state, pool);
    }
  };
  move(900);
  const auto calm = Points(*groom, state, kPoints, pool);
  EXPECT_LT(Farthest(calm, Points(*groom, AtRest(*groom, {}), kPoints, pool)), 1e-3);
  air.air_drag_scale = 0;  // Nothing slows what would be off now.
  SwitchModel(*groom, beams, kPoints, &state, pool);
  move(20);
  HeadState still = AtRest(*groom, {});
  StartBeams(beams, &still);
  EXPECT_LT(Farthest(Points(*groom, state, 17, pool), Points(*groom, still, 17, pool)), 1e-3);
  SwitchModel(*groom, nullptr, kPoints, &state, pool);
  move(20);
  EXPECT_LT(Farthest(Points(*groom, state, kPoints, pool), calm), 2e-3);
}

TEST(ModelSwitchTest, SwingingHairGoesOnSwinging) {
  exec::WorkerPool pool(1);
  const auto groom = GeneratedGroom(groom::HairType::kAsianSmooth, 20, 0.25, 6);
  BeamOptions options;
  options.avoid_head = false;  // Rods swing through it.
  const auto beams = MakeBeams(*groom, nullptr, options, pool);
  for (const bool to_beams : {true, false}) {
    HeadState state = AtRest(*groom, {});
    if (!to_beams) StartBeams(beams, &state);
    for (int i = 0; i < 20; ++i) {  // Pushed off, and left to swing.
      math::Pose to = state.pose;
      to.p.x() += i < 10 ? 0.01 : 0;
      Advance(*groom, {to, 1 / 60.0, 1}, {}, &state, pool);
    }
    const auto move = [&] {
      const auto before = Points(*groom, state, 2, pool);
      Advance(*groom, {state.pose, 1 / 60.0, 1}, {}, &state, pool);
      const auto after = Points(*groom, state, 2, pool);
      Vector3d sum = Vector3d::Zero();  // Of all tips.
      for (size_t i = 1; i < after.size(); i += 2) sum += (after[i] - before[i]).cast<double>();
      return Vector3d(sum / groom->guide_count());
    };
    const Vector3d last = move();
    EXPECT_GT(last.norm(), 2e-3);
    SwitchModel(*groom, to_beams ? beams : nullptr, 2, &state, pool);
    EXPECT_LT((move() - last).norm(), 0.35 * last.norm()) << to_beams;
  }
}

TEST(ModelSwitchTest, BeamsTurnWithTheHead) {
  exec::WorkerPool pool(1);
  const auto groom = SampleGroom(8, 5);
  const auto beams = MakeBeams(*groom, nullptr, {}, pool);
  HeadState state = AtRest(*groom, Shaken(1));
  state.beams.spin = {1, 2, -0.5};
  SwitchModel(*groom, beams, kPoints, &state, pool);
  const int k = beams->segments;
  std::vector<Vector3d> directions(k), rates(k);
  for (int guide = 0; guide < groom->guide_count(); ++guide) {
    beams->batch.GetHair(guide, state.beams.duration, state.beams.rows, directions, rates);
    for (int i = 0; i < k; ++i) {
      EXPECT_LT((rates[i] - state.beams.spin.cross(directions[i])).norm(), 1e-4) << guide;
    }
  }
}

TEST(TransitionTest, WhatIsShownOnFadesSmoothly) {
  const Transition transition{2, 5.0, {}};
  EXPECT_EQ(Remaining(transition, 5.0), 1);
  EXPECT_EQ(Remaining(transition, 5.0 + kTransitionTime), 0);
  EXPECT_NEAR(Remaining(transition, 5.0 + kTransitionTime / 2), 0.5, 1e-12);
  EXPECT_GT(Remaining(transition, 5.0 + 1 / 60.0), 0.98);
  EXPECT_EQ(Remaining(transition, 9.0), 0);
}

TEST(TransitionTest, OffsetsMakeNoChordLongerThanItsArc) {
  std::vector<Vector3f> points = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  const std::vector<Vector3f> offsets = {{0, 0.1F, 0}, {0, 3, 0}};
  AddOffsets(1, Eigen::Matrix3f::Identity(), offsets, 1.01F, points);
  EXPECT_LT((points[1] - Vector3f(1, 0.1F, 0)).norm(), 1e-6);
  EXPECT_NEAR((points[2] - points[1]).norm(), 1.01, 1e-6);
  EXPECT_GT(points[2].y(), points[1].y() + 0.9);
}

}  // namespace
}  // namespace mane::head
