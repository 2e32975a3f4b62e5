// A game goes on when the network breaks, the daemon is killed, or it hangs.

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include "cut_proxy.h"
#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

using Clock = std::chrono::steady_clock;

double Now() { return std::chrono::duration<double>(Clock::now().time_since_epoch()).count(); }

// Pushes poses and polls frames until `condition(newest frame, status)` holds.
template <typename Condition>
bool PlayUntil(Head& head, double start, Condition condition) {
  return Eventually([&] {
    const double t = Now() - start;
    const auto pushed = head.PushPose(t, MotionAt(t));
    EXPECT_TRUE(pushed) << pushed.error().message;
    return condition(head.NewestFrame(), head.Status()) || !pushed;
  });
}

HeadOptions Realtime(const std::string& groom) {
  HeadOptions options;
  options.groom = groom;
  options.initial_pose = MotionAt(0);
  return options;
}

TEST(E2eFailures, HeadsComeBackAfterKill9AndRestartOfTheDaemon) {
  Daemon daemon;
  Client client = daemon.Connect();
  const GroomUpload upload = WavyGroom(8);
  const std::string groom = Create(client, upload);
  const double start = Now();
  std::vector<Head> heads;
  for (int h = 0; h < 4; ++h) {
    HeadOptions options = Realtime(groom);
    options.format = h % 2 ? FrameFormat::kGeneralized : FrameFormat::kPositionsFloat32;
    heads.push_back(client.OpenHead(options));
  }
  for (Head& head : heads) {
    ASSERT_TRUE(PlayUntil(
        head, start, [](const auto& frame, const auto&) { return frame && frame->index > 10; }));
  }
  daemon.Kill();
  for (Head& head : heads) {
    EXPECT_TRUE(PlayUntil(head, start, [](const auto&, const HeadStatus& status) {
      return status.state == HeadState::kReconnecting;
    }));
    EXPECT_EQ(head.Status().error->code, ErrorCode::kUnavailable);
    EXPECT_NE(head.NewestFrame(), nullptr) << "the last frame stays";
  }
  const double killed_at = Now() - start;
  daemon.Start();
  for (Head& head : heads) {
    EXPECT_TRUE(PlayUntil(head, start, [&](const auto& frame, const HeadStatus& status) {
      return status.state == HeadState::kStreaming && frame->newest_pose_time_s > killed_at;
    }));
    EXPECT_EQ(head.Status().reopenings, 1u);
    EXPECT_EQ(head.Status().resumes, 0u);
    EXPECT_FALSE(head.Status().error);
    EXPECT_EQ(Fault(*head.NewestFrame(), upload), "");
  }
}

TEST(E2eFailures, ABrokenNetworkIsResumedWithoutAJump) {
  Daemon daemon;
  CutProxy proxy(daemon.port());
  auto connected = Client::Connect({.address = "127.0.0.1:" + std::to_string(proxy.port())});
  ASSERT_TRUE(connected);
  Client client = *std::move(connected);
  const GroomUpload upload = WavyGroom(4);
  Head head = client.OpenHead(Realtime(Create(client, upload)));
  ASSERT_TRUE(head.SetEnvironment({.air_drag_scale = 2}));
  const double start = Now();
  std::uint64_t last = 0;
  for (std::uint32_t cut = 1; cut <= 3; ++cut) {
    const std::uint64_t wanted = last + 20;
    ASSERT_TRUE(PlayUntil(head, start, [&](const auto& frame, const auto&) {
      if (!frame) return false;
      EXPECT_GE(frame->index, last) << "frames go on counting after a resume";
      last = frame->index;
      EXPECT_EQ(Fault(*frame, upload), "");
      return frame->index >= wanted;
    }));
    proxy.Cut();
    ASSERT_TRUE(PlayUntil(
        head, start, [&](const auto&, const HeadStatus& status) { return status.resumes == cut; }));
  }
  EXPECT_EQ(head.Status().reopenings, 0u);
}

TEST(E2eFailures, HeadsAreDestroyedDuringTraffic) {
  Daemon daemon;
  Client client = daemon.Connect();
  const std::string groom = Create(client, WavyGroom(10));
  for (int round = 0; round < 15; ++round) {
    const double start = Now();
    Head head = client.OpenHead(Realtime(groom));
    PlayUntil(head, start, [&](const auto& frame, const auto&) {
      return round % 3 == 0 || (frame && frame->index >= static_cast<std::uint64_t>(round));
    });
  }
  EXPECT_TRUE(client.GetGroom(groom)) << "the daemon is well";
}

// That these destructors return is what is tested; the test's time limit is the bound.
TEST(E2eFailures, DestructorsReturnWhenTheDaemonIsGoneOrHangs) {
  Daemon daemon;
  Client client = daemon.Connect();
  const std::string groom = Create(client, WavyGroom(3));
  HeadOptions lockstep = Realtime(groom);
  lockstep.pacing = Pacing::kLockstep;
  const double start = Now();
  const auto frames_come = [](const auto& frame, const auto&) { return frame != nullptr; };
  {
    Head realtime = client.OpenHead(Realtime(groom));
    Head stepped = client.OpenHead(lockstep);
    ASSERT_TRUE(PlayUntil(realtime, start, frames_come));
    ASSERT_TRUE(stepped.Step(0, {}));
    daemon.Stop();
    Head unanswered = client.OpenHead(Realtime(groom));
    EXPECT_TRUE(realtime.PushPose(Now() - start, {}));
  }
  daemon.Continue();
  Head realtime = client.OpenHead(Realtime(groom));
  ASSERT_TRUE(PlayUntil(realtime, start, frames_come));
  daemon.Kill();
  Head refused = client.OpenHead(Realtime(groom));
}

TEST(E2eFailures, ManyThreadsShareAHeadWhileTheDaemonRestarts) {
  Daemon daemon;
  Client client = daemon.Connect();
  Head head = client.OpenHead(Realtime(Create(client, WavyGroom(3))));
  std::atomic<bool> stop = false;
  const double start = Now();
  std::vector<std::thread> threads;
  for (int i = 0; i < 3; ++i) {
    threads.emplace_back([&] {
      while (!stop) {
        const double t = Now() - start;
        (void)head.PushPose(t, MotionAt(t));  // Refused when another thread was faster.
        head.NewestFrame();
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    });
  }
  EXPECT_TRUE(Eventually([&] { return head.NewestFrame() != nullptr; }));
  daemon.Kill();
  EXPECT_TRUE(Eventually([&] { return head.Status().state == HeadState::kReconnecting; }));
  daemon.Start();
  EXPECT_TRUE(Eventually([&] { return head.Status().reopenings == 1; }));
  stop = true;
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(head.Status().state, HeadState::kStreaming);
}

}  // namespace
}  // namespace mane::client_test
