// Heads among each other: lockstep replays, real time keeps its clock and its window, and one
// head's fault or end leaves the others alone.

#include "session/registry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>

#include "session/test_heads.h"

namespace mane::session {
namespace {

// A lockstep client that always has more poses waiting.
class TirelessStream final : public FrameSink {
 public:
  void Run(HeadSession* head) {
    head_ = head;
    OnProgress();
  }
  void Stop() { stopped_ = true; }
  void OnProgress() override {
    HeadSession* head = head_;
    if (head == nullptr) return;
    while (head->TakeFrame().frame) ++frames_;
    std::lock_guard lock(mutex_);
    while (!stopped_ && head->Backlog() < 8) {
      EXPECT_TRUE(head->Submit(PoseCommand{++poses_ / 60.0, {}}));
    }
  }
  void OnNotice(const Notice& /*notice*/) override {}
  void OnEnd(const Error& /*error*/) override {}
  [[nodiscard]] int frames() const { return frames_; }

 private:
  std::atomic<HeadSession*> head_ = nullptr;
  std::atomic<bool> stopped_ = false;
  std::atomic<int> frames_ = 0;
  std::mutex mutex_;
  int poses_ = 0;
};

TEST_F(RegistryTest, LockstepGivesOneFrameAPoseAndReplaysTheSameBits) {
  Registry registry({}, pool_, pool_);
  std::vector<std::vector<FramePtr>> runs;
  for (int run = 0; run < 2; ++run) {
    TestStream stream;
    const auto head = Open(registry, stream, Pacing::kLockstep);
    for (int i = 0; i < 40; ++i) {
      ASSERT_TRUE(head->Submit(Pose(i)));
      if (i == 20) {
        ASSERT_TRUE(head->Submit(EnvironmentCommand{Eigen::Vector3d(1, 0, 0), {}, {}, {}}));
      }
      if (i == 30) {
        ASSERT_TRUE(head->Submit(ResetCommand{}));
      }
    }
    ASSERT_TRUE(stream.WaitForFrames(40));
    registry.Close(head, &stream);
    runs.push_back(stream.frames());
  }
  ASSERT_EQ(runs[0].size(), 40u);
  for (size_t i = 0; i < 40; ++i) {
    EXPECT_EQ(runs[0][i]->index, i + 1);
    EXPECT_EQ(runs[0][i]->time, static_cast<double>(i) / 60);
    EXPECT_EQ(runs[0][i]->data, runs[1][i]->data) << i;
  }
  EXPECT_NE(runs[0][10]->data, runs[0][20]->data);
}

TEST_F(RegistryTest, ALockstepHeadThatAlwaysHasMoreLeavesOthersTheirTurn) {
  exec::WorkerPool one(1);
  Registry registry({}, pool_, one);
  TirelessStream busy;
  HeadOptions options;
  options.pacing = Pacing::kLockstep;
  const auto tireless = registry.Open({groom_}, options, "", &busy);
  ASSERT_TRUE(tireless);
  busy.Run(tireless->head.get());
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kLockstep);
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(head->Submit(Pose(i)));
  EXPECT_TRUE(stream.WaitForFrames(5));
  EXPECT_GT(busy.frames(), 0);
  busy.Stop();
  registry.Close(tireless->head, &busy);
  registry.Close(head, &stream);
}

TEST_F(RegistryTest, TimesMustIncreaseAndLockstepGapsAreLimited) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kLockstep);
  ASSERT_TRUE(head->Submit(PoseCommand{5, {}}));
  for (const double time : {5.0, 4.0, 6.5}) {
    const auto result = head->Submit(PoseCommand{time, {}});
    ASSERT_FALSE(result) << time;
    EXPECT_EQ(result.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(result.error().field, "pose.time_s");
  }
  const auto back = head->Submit(PoseCommand{4, {}, /*teleport=*/true});
  ASSERT_FALSE(back);
  EXPECT_EQ(back.error().field, "teleport.time_s");
  EXPECT_TRUE(head->Submit(PoseCommand{100, {}, /*teleport=*/true}));
  EXPECT_TRUE(head->Submit(PoseCommand{101, {}}));
  EXPECT_FALSE(head->Submit(PoseCommand{102.00001, {}}));
  registry.Close(head, &stream);
}

TEST_F(RegistryTest, AGapOfOneSecondIsAllowedHoweverItsTimesAreRounded) {
  Registry registry({}, pool_, pool_);
  int above = 0;
  for (const auto& [first, second] :
       {std::pair{1.2, 2.2}, {3.4, 4.4}, {0.1, 1.1}, {1.7e9, 1.7e9 + 1.0000002}}) {
    above += second - first > 1;
    TestStream stream;
    const auto head = Open(registry, stream, Pacing::kLockstep);
    EXPECT_TRUE(head->Submit(PoseCommand{first, {}}));
    EXPECT_TRUE(head->Submit(PoseCommand{second, {}})) << first;
    EXPECT_TRUE(stream.WaitForFrames(2));
    registry.Close(head, &stream);
  }
  EXPECT_GT(above, 0);  // Some of them round upward.
}

TEST_F(RegistryTest, RealtimeTicksByItself) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kRealtime);
  for (uint64_t acked = 0, i = 0; acked < 30; ++i) {
    ASSERT_TRUE(stream.WaitFor([&](const TestStream& s) {
      return !s.frames_.empty() && s.frames_.back()->index > acked;
    }));
    acked = stream.frames().back()->index;
    ASSERT_TRUE(head->Submit(Pose(static_cast<int>(i))));
    ASSERT_TRUE(head->Acknowledge(acked));
  }
  registry.Close(head, &stream);
  const auto frames = stream.frames();
  for (size_t i = 1; i < frames.size(); ++i) {
    EXPECT_GT(frames[i]->index, frames[i - 1]->index);
    EXPECT_GE(frames[i]->time, frames[i - 1]->time);
  }
  // The head is shown at the newest pose it knows, or at most kMaxExtrapolation later.
  EXPECT_GE(frames.back()->newest_pose_time, frames.back()->time - 1);
}

TEST_F(RegistryTest, FramesAreNeverOlderThanTheFirstPose) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  HeadOptions options;
  options.rate_hz = 120;
  options.pose_delay = 0.05;
  const auto opened = registry.Open({groom_}, options, "", &stream);
  ASSERT_TRUE(opened);
  stream.Follow(opened->head);
  constexpr double kFirst = 1000;
  const auto start = std::chrono::steady_clock::now();
  for (uint64_t acked = 0; acked < 30;) {
    ASSERT_TRUE(stream.WaitFor([&](const TestStream& s) {
      return !s.frames_.empty() && s.frames_.back()->index > acked;
    }));
    acked = stream.frames().back()->index;
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - start;
    ASSERT_TRUE(opened->head->Submit(PoseCommand{kFirst + since.count(), {}}));
    ASSERT_TRUE(opened->head->Acknowledge(acked));
  }
  registry.Close(opened->head, &stream);
  double last = kFirst;
  for (const FramePtr& frame : stream.frames()) {
    if (frame->newest_pose_time == 0) continue;  // Before the first pose.
    EXPECT_GE(frame->time, last);
    last = frame->time;
  }
  EXPECT_GT(last, kFirst + 0.05);
}

TEST_F(RegistryTest, AReaderThatAcknowledgesNothingGetsTheWindowAndThenTheNewest) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kRealtime);
  ASSERT_TRUE(stream.WaitForFrames(3));
  const uint64_t third = stream.frames().back()->index;
  // The head goes on while nothing is taken.
  EXPECT_TRUE(WaitUntil([&] { return head->next_frame() >= third + 10; }));
  EXPECT_EQ(stream.frames().size(), 3u);
  ASSERT_TRUE(head->Acknowledge(third));
  stream.OnProgress();
  ASSERT_TRUE(stream.WaitForFrames(4));
  EXPECT_GE(stream.frames()[3]->index, third + 9);
  EXPECT_GE(stream.skipped_, 8u);
  EXPECT_LE(head->Backlog(), 2);
  registry.Close(head, &stream);
}

TEST_F(RegistryTest, ASlowRateMovesHairAllTheSame) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  HeadOptions options;
  options.rate_hz = 1.5;
  const auto opened = registry.Open({groom_}, options, "", &stream);
  ASSERT_TRUE(opened);
  stream.Follow(opened->head);
  ASSERT_TRUE(opened->head->Submit(EnvironmentCommand{{}, Eigen::Vector3d(9.81, 0, 0), {}, {}}));
  ASSERT_TRUE(stream.WaitForFrames(2));
  EXPECT_NE(stream.frames()[0]->data, stream.frames()[1]->data);
  registry.Close(opened->head, &stream);
}

TEST_F(RegistryTest, AClockOfAnyOriginIsFollowed) {
  Registry registry({}, pool_, pool_);
  for (const double origin : {-1e6, 0.5, 1e9}) {
    TestStream stream;
    const auto head = Open(registry, stream, Pacing::kRealtime);
    ASSERT_TRUE(head->Submit(PoseCommand{origin, {}}));
    ASSERT_TRUE(stream.WaitFor([](const TestStream& s) {
      return !s.frames_.empty() && s.frames_.back()->newest_pose_time != 0;
    }));
    ASSERT_TRUE(stream.WaitForFrames(3));
    // Shown at the pose's time or a little later; the test's own delays count.
    EXPECT_NEAR(stream.frames().back()->time, origin, 20) << origin;
    registry.Close(head, &stream);
  }
}

TEST_F(RegistryTest, AFaultEndsOneHeadAndNoOther) {
  Registry registry({}, pool_, pool_);
  TestStream sick, well;
  HeadOptions bad;  // Validation keeps such a view out; here it stands for a fault of the program.
  bad.pacing = Pacing::kLockstep;
  bad.view.points_per_guide = 1;
  const auto broken = registry.Open({groom_}, bad, "", &sick)->head;
  const auto healthy = Open(registry, well, Pacing::kLockstep);
  ASSERT_TRUE(broken->Submit(PoseCommand{0, {}}));
  ASSERT_TRUE(sick.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  EXPECT_EQ(sick.end_->code, ErrorCode::kInternal);
  EXPECT_FALSE(broken->Submit(PoseCommand{1, {}}));
  for (int i = 0; i < 5; ++i) ASSERT_TRUE(healthy->Submit(Pose(i)));
  ASSERT_TRUE(well.WaitForFrames(5));
  registry.Close(broken, &sick);
  registry.Close(healthy, &well);
}

TEST_F(RegistryTest, ClientsAreToldWhenPosesStayAway) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kRealtime);
  ASSERT_TRUE(stream.WaitFor([](const TestStream& s) { return !s.notices_.empty(); }));
  const auto is_no_poses = [](const Notice& n) { return n.code == Notice::Code::kNoPoses; };
  ASSERT_TRUE(stream.WaitFor(
      [&](const TestStream& s) { return std::ranges::any_of(s.notices_, is_no_poses); }));
  registry.Close(head, &stream);
}

}  // namespace
}  // namespace mane::session
