// REALTIME through the client and the real daemon: fresh frames for many heads at once.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

using Clock = std::chrono::steady_clock;

double Now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

// Plays a head for `count` frames as a game would, and checks each. A fault fails the test.
void PlayRealtime(Client& client, const HeadOptions& options, const GroomUpload& upload,
                  int count) {
  Head head = client.OpenHead(options);
  const double start = Now();
  std::uint64_t last = 0;
  double last_time = -1;
  int seen = 0;
  const bool finished = Eventually([&] {
    const double t = Now() - start;
    const auto pushed = head.PushPose(t, MotionAt(t));
    EXPECT_TRUE(pushed) << pushed.error().message;
    const auto frame = head.NewestFrame();
    if (frame && frame->index != last) {
      EXPECT_GT(frame->index, last);
      EXPECT_GE(frame->time_s, last_time);
      EXPECT_LE(frame->newest_pose_time_s, t);
      EXPECT_EQ(Fault(*frame, upload), "") << "frame " << frame->index;
      last = frame->index;
      last_time = frame->time_s;
      ++seen;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(7));
    return seen >= count || !pushed;
  });
  EXPECT_TRUE(finished) << "only " << seen << " frames";
  EXPECT_EQ(head.Status().state, HeadState::kStreaming);
}

TEST(E2eRealtime, EightHeadsAtOnceGetSoundFrames) {
  Daemon daemon;
  Client client = daemon.Connect();
  const GroomUpload upload = WavyGroom(20);
  HeadOptions options;
  options.groom = Create(client, upload);
  options.initial_pose = MotionAt(0);
  const FrameFormat formats[] = {FrameFormat::kPositionsFloat32, FrameFormat::kPositionsQuantized16,
                                 FrameFormat::kGeneralized};
  std::vector<std::thread> threads;
  for (int h = 0; h < 8; ++h) {
    options.format = formats[h % 3];
    options.pose_delay_s = h % 2 ? 0.02 : 0;
    threads.emplace_back(
        [&client, &upload, options] { PlayRealtime(client, options, upload, 90); });
  }
  for (std::thread& thread : threads) thread.join();
}

TEST(E2eRealtime, PollingAloneKeepsFramesComing) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options;
  options.groom = Create(client, WavyGroom(2));
  options.max_unacked_frames = 1;
  Head head = client.OpenHead(options);
  ASSERT_TRUE(head.PushPose(0, {}));
  EXPECT_TRUE(Eventually([&] {  // No pose follows that could carry an acknowledgement.
    const auto frame = head.NewestFrame();
    return frame && frame->index >= 20;
  }));
}

TEST(E2eRealtime, WhoLooksAwaySkipsFramesAndThenSeesAFreshOne) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options;
  options.groom = Create(client, WavyGroom(2));
  options.max_unacked_frames = 1;
  Head head = client.OpenHead(options);
  const double start = Now();
  const auto push = [&] {
    const double t = Now() - start;
    EXPECT_TRUE(head.PushPose(t, MotionAt(t)));
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    return t;
  };
  EXPECT_TRUE(Eventually([&] {
    const double from = push();
    while (push() < from + 0.3) {
    }  // Looks away: acknowledges nothing.
    const auto first = head.NewestFrame();
    if (!first) return false;
    for (int i = 0; i < 40; ++i) {
      push();
      const auto frame = head.NewestFrame();
      if (frame->skipped > 0) return frame->index > first->index + frame->skipped;
    }
    return false;
  }));
}

TEST(E2eRealtime, ChangesReachAStreamingHead) {
  Daemon daemon;
  Client client = daemon.Connect();
  HeadOptions options;
  options.groom = Create(client, WavyGroom(4));
  options.space = Space::kHead;
  Head calm = client.OpenHead(options), windy = client.OpenHead(options);
  ASSERT_TRUE(windy.SetEnvironment({.wind_velocity = Vector3{8, 0, 0}}));
  const double start = Now();
  EXPECT_TRUE(Eventually([&] {
    const double t = Now() - start;
    EXPECT_TRUE(calm.PushPose(t, {}));
    EXPECT_TRUE(windy.PushPose(t, {}));
    const auto a = calm.NewestFrame(), b = windy.NewestFrame();
    return a && b && Distance(PointOf(*a, 0, 15), PointOf(*b, 0, 15)) > 0.005;
  }));
  Pose far;
  far.position = {1000, 0, 0};
  ASSERT_TRUE(windy.Teleport(Now() - start, far));
  ASSERT_TRUE(windy.Reset());
  EXPECT_TRUE(Eventually([&] {
    const auto frame = windy.NewestFrame();
    return frame->head_pose.position.x == 1000;
  }));
  EXPECT_EQ(windy.Status().state, HeadState::kStreaming);
}

}  // namespace
}  // namespace mane::client_test
