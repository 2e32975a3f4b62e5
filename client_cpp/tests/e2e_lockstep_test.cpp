// LOCKSTEP through the client and the real daemon: every pose one frame, the same bits each time,
// and the same hair in every format and space.

#include <gtest/gtest.h>

#include <cmath>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

using FramePtr = std::shared_ptr<const Frame>;
using Frames = std::vector<FramePtr>;

constexpr double kStep = 1.0 / 60;

HeadOptions Lockstep(const std::string& groom) {
  HeadOptions options;
  options.groom = groom;
  options.pacing = Pacing::kLockstep;
  return options;
}

// Plays a motion with everything in it: wind, a reset, a teleport.
Frames Play(Client& client, const HeadOptions& options, int steps) {
  Head head = client.OpenHead(options);
  Frames frames;
  for (int i = 0; i < steps; ++i) {
    const double t = i * kStep;
    if (i == steps / 4) {
      EXPECT_TRUE(head.SetEnvironment({.wind_velocity = Vector3{3, 0, 1}}));
    }
    if (i == steps / 2) {
      EXPECT_TRUE(head.Reset());
    }
    const auto frame =
        i == steps * 3 / 4 ? head.StepTeleport(t, MotionAt(t + 5)) : head.Step(t, MotionAt(t));
    if (!frame) {
      ADD_FAILURE() << frame.error().field << ": " << frame.error().message;
      break;
    }
    frames.push_back(*frame);
  }
  return frames;
}

// Largest distance between two frames' points, the second brought to the first one's space [m].
double Difference(const Frame& a, const Frame& b, const Pose& b_to_a = {}) {
  double worst = 0;
  for (std::uint32_t g = 0; g < a.guide_count; ++g) {
    for (std::uint32_t i = 0; i < a.points_per_guide; ++i) {
      worst = std::max(worst, Distance(PointOf(a, g, i), Apply(b_to_a, PointOf(b, g, i))));
    }
  }
  return worst;
}

TEST(E2eLockstep, AHeadChangesItsModel) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options = Lockstep(Create(client, WavyGroom(6)));
  options.model = AnimationModel::kBeam;
  options.beam.segments = 9;
  Head head = client.OpenHead(options);
  for (int i = 0; i < 12; ++i) {
    if (i == 4) {
      EXPECT_TRUE(head.SetModel(AnimationModel::kSuperHelix));
    }
    if (i == 8) {
      EXPECT_TRUE(head.SetModel(AnimationModel::kBeam));
    }
    const auto frame = head.Step(i * kStep, MotionAt(i * kStep));
    ASSERT_TRUE(frame) << frame.error().message;
    const bool beam = i < 4 || i >= 8;
    EXPECT_EQ((*frame)->model, beam ? AnimationModel::kBeam : AnimationModel::kSuperHelix) << i;
    if (beam) {
      EXPECT_EQ((*frame)->stepped_elements, 6U * 9U);
    }
  }
}

TEST(E2eLockstep, EightHeadsAtOnceReplayBitForBit) {
  constexpr int kHeads = 8, kSteps = 90;
  Daemon daemon;
  Client client = daemon.Connect();
  const GroomUpload upload = WavyGroom(12);
  const HeadOptions options = Lockstep(Create(client, upload));
  const Frames alone = Play(client, options, kSteps);
  ASSERT_EQ(alone.size(), size_t{kSteps});
  for (size_t i = 0; i < alone.size(); ++i) {
    EXPECT_EQ(alone[i]->index, i + 1);
    EXPECT_EQ(alone[i]->time_s, static_cast<double>(i) * kStep);
    EXPECT_EQ(Fault(*alone[i], upload), "") << "frame " << i;
  }
  EXPECT_GT(Difference(*alone[20], *alone[0]), 0.01) << "nothing moved";

  std::vector<std::future<Frames>> heads;
  for (int h = 0; h < kHeads; ++h) {
    heads.push_back(std::async(std::launch::async, [&] { return Play(client, options, kSteps); }));
  }
  for (auto& head : heads) {
    const Frames frames = head.get();
    ASSERT_EQ(frames.size(), alone.size());
    for (size_t i = 0; i < frames.size(); ++i) {
      ASSERT_EQ(frames[i]->positions, alone[i]->positions) << "frame " << i;
    }
  }
}

TEST(E2eLockstep, DiagnosticsComeWhereTheyAreAskedFor) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options = Lockstep(Create(client, WavyGroom(3)));
  for (const FramePtr& frame : Play(client, options, 5)) EXPECT_FALSE(frame->diagnostics);
  options.diagnostics = true;
  const Frames frames = Play(client, options, 20);
  ASSERT_EQ(frames.size(), 20u);
  for (const FramePtr& frame : frames) ASSERT_TRUE(frame->diagnostics) << frame->index;
  EXPECT_EQ(frames[0]->diagnostics->kinetic_energy_j, 0);
  EXPECT_LT(frames[0]->diagnostics->imbalance, 1e-3);
  EXPECT_GT(frames[9]->diagnostics->kinetic_energy_j, 0);
  EXPECT_GT(frames[9]->diagnostics->largest_angle_rad, 0);
}

TEST(E2eLockstep, BitsSurviveARestartOfTheDaemon) {
  Daemon daemon;
  HeadOptions options;
  Frames before;
  {
    Client client = daemon.Connect();
    options = Lockstep(Create(client, WavyGroom(5)));
    before = Play(client, options, 40);
  }
  daemon.Kill();
  daemon.Start();
  Client client = daemon.Connect();
  const Frames after = Play(client, options, 40);
  ASSERT_EQ(before.size(), after.size());
  for (size_t i = 0; i < after.size(); ++i) EXPECT_EQ(before[i]->positions, after[i]->positions);
}

TEST(E2eLockstep, EveryFormatAndSpaceShowsTheSameHair) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options = Lockstep(Create(client, WavyGroom(6)));
  options.points_per_guide = 25;
  const Frames reference = Play(client, options, 60);
  const struct {
    FrameFormat format;
    double tolerance;  // [m]: half a step in a box of 20 cm; float32 at 2 m.
  } cases[] = {{FrameFormat::kPositionsFloat32, 1e-6},
               {FrameFormat::kPositionsQuantized16, 4e-6},
               {FrameFormat::kGeneralized, 1e-6}};
  for (const auto& [format, tolerance] : cases) {
    for (const Space space : {Space::kWorld, Space::kHead}) {
      SCOPED_TRACE(::testing::Message() << "format " << static_cast<int>(format) << ", space "
                                        << static_cast<int>(space));
      options.format = format;
      options.space = space;
      const Frames frames = Play(client, options, 60);
      ASSERT_EQ(frames.size(), reference.size());
      for (size_t i = 0; i < frames.size(); ++i) {
        const Pose to_world = space == Space::kHead ? frames[i]->head_pose : Pose{};
        EXPECT_LT(Difference(*reference[i], *frames[i], to_world), tolerance) << "frame " << i;
      }
      EXPECT_EQ(frames[0]->angles.empty(), format != FrameFormat::kGeneralized);
    }
  }
}

TEST(E2eLockstep, ATeleportKeepsTheShapeInTheHead) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options = Lockstep(Create(client, WavyGroom(6)));
  options.space = Space::kHead;
  Head head = client.OpenHead(options);
  FramePtr before;
  for (int i = 0; i < 30; ++i) before = *head.Step(i * kStep, MotionAt(i * kStep));
  Pose far = MotionAt(30 * kStep);
  far.position = {100, -50, 7};
  const auto after = head.StepTeleport(30 * kStep, far);
  ASSERT_TRUE(after);
  EXPECT_EQ((*after)->head_pose.position.x, 100);
  EXPECT_LT(Difference(*before, **after), 1e-6);
}

TEST(E2eLockstep, AResetHeadHangsInItsRestShape) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options = Lockstep(Create(client, WavyGroom(6)));
  options.space = Space::kHead;
  Head head = client.OpenHead(options);
  FramePtr moved;
  for (int i = 0; i < 40; ++i) moved = *head.Step(i * kStep, MotionAt(i * kStep));
  ASSERT_TRUE(head.StepTeleport(40 * kStep, {}));
  ASSERT_TRUE(head.Reset());
  const auto frame = head.Step(41 * kStep, {});
  ASSERT_TRUE(frame);
  const auto rest = client.ComputeRestShape(options.groom);
  ASSERT_TRUE(rest);
  ASSERT_EQ(rest->positions.size(), (*frame)->positions.size());
  double worst = 0;
  for (size_t i = 0; i < rest->positions.size(); ++i) {
    worst = std::max(worst, std::abs(rest->positions[i] - (*frame)->positions[i]));
  }
  EXPECT_LT(worst, 1e-5);
  EXPECT_GT(Difference(*moved, **frame), 0.01) << "the motion had bent it";
}

TEST(E2eLockstep, TheEnvironmentActsFromTheNextStep) {
  Daemon daemon;
  Client client = daemon.Connect();
  const HeadOptions options = Lockstep(Create(client, WavyGroom(4)));
  Head still = client.OpenHead(options), windy = client.OpenHead(options);
  ASSERT_TRUE(windy.SetEnvironment({.wind_velocity = Vector3{8, 0, 0}}));
  FramePtr a, b;
  for (int i = 0; i < 30; ++i) {
    a = *still.Step(i * kStep, {});
    b = *windy.Step(i * kStep, {});
  }
  EXPECT_GT(Difference(*a, *b), 0.005);
}

TEST(E2eLockstep, AKilledDaemonEndsAStepWithUnavailable) {
  Daemon daemon;
  Client client = daemon.Connect();
  Head head = client.OpenHead(Lockstep(Create(client, WavyGroom(2))));
  ASSERT_TRUE(head.Step(0, {}));
  daemon.Kill();
  const auto step = head.Step(1, {});
  ASSERT_FALSE(step);
  EXPECT_EQ(step.error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(head.Status().state, HeadState::kClosed);
}

}  // namespace
}  // namespace mane::client_test
