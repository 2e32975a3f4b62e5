// Heads among each other: lockstep replays, real time keeps its clock and its window, broken
// streams come back, limits hold, and one head's fault or end leaves the others alone.

#include "session/registry.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <utility>

#include "head/sample_groom.h"
#include "session/admission.h"

namespace mane::session {
namespace {

using std::chrono::seconds;

// A stream that takes all frames as they come, and lets a test wait for what it wants to see.
class TestStream final : public FrameSink {
 public:
  void Follow(std::shared_ptr<HeadSession> head) {
    std::lock_guard lock(mutex_);
    head_ = std::move(head);
  }
  void OnProgress() override {
    std::lock_guard lock(mutex_);
    if (head_ == nullptr || paused_) return;
    for (OutgoingFrame out = head_->TakeFrame(); out.frame; out = head_->TakeFrame()) {
      frames_.push_back(out.frame);
      skipped_ += out.skipped;
    }
    changed_.notify_all();
  }
  void OnNotice(const Notice& notice) override {
    std::lock_guard lock(mutex_);
    notices_.push_back(notice);
    changed_.notify_all();
  }
  void OnEnd(const Error& error) override {
    std::lock_guard lock(mutex_);
    end_ = error;
    changed_.notify_all();
  }

  [[nodiscard]] bool WaitFor(const std::function<bool(const TestStream&)>& done) {
    std::unique_lock lock(mutex_);
    return changed_.wait_for(lock, seconds(20), [&] { return done(*this); });
  }
  [[nodiscard]] bool WaitForFrames(size_t count) {
    return WaitFor([count](const TestStream& s) { return s.frames_.size() >= count; });
  }
  [[nodiscard]] std::vector<FramePtr> frames() {
    std::lock_guard lock(mutex_);
    return frames_;
  }

  // Guarded by mutex_; read by conditions, or when the head is quiet.
  std::vector<FramePtr> frames_;
  std::vector<Notice> notices_;
  std::optional<Error> end_;
  uint32_t skipped_ = 0;
  bool paused_ = false;

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<HeadSession> head_;
};

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

class RegistryTest : public ::testing::Test {
 protected:
  std::shared_ptr<HeadSession> Open(Registry& registry, TestStream& stream, Pacing pacing,
                                    const std::string& request_id = "") {
    HeadOptions options;
    options.pacing = pacing;
    options.rate_hz = 120;
    const auto opened = registry.Open(groom_, options, request_id, &stream);
    EXPECT_TRUE(opened) << (opened ? "" : opened.error().message);
    if (!opened) return nullptr;
    token_ = opened->resume_token;
    stream.Follow(opened->head);
    return opened->head;
  }

  static PoseCommand Pose(int i) {
    return {i / 60.0, {{0.05 * std::sin(0.3 * i), 0, 0}, Eigen::Quaterniond::Identity()}};
  }

  exec::WorkerPool pool_{2};
  std::shared_ptr<const groom::Groom> groom_ = head::SampleGroom(12, 4);
  std::string token_;
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
  const auto tireless = registry.Open(groom_, options, "", &busy);
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
  registry.Close(head, &stream);
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
  const auto opened = registry.Open(groom_, options, "", &stream);
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
  const auto deadline = std::chrono::steady_clock::now() + seconds(20);
  while (head->next_frame() < third + 10 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  ASSERT_GE(head->next_frame(), third + 10);
  EXPECT_EQ(stream.frames().size(), 3u);
  ASSERT_TRUE(head->Acknowledge(third));
  stream.OnProgress();
  ASSERT_TRUE(stream.WaitForFrames(4));
  EXPECT_GE(stream.frames()[3]->index, third + 9);
  EXPECT_GE(stream.skipped_, 8u);
  EXPECT_LE(head->Backlog(), 2);
  registry.Close(head, &stream);
}

TEST_F(RegistryTest, ABrokenStreamComesBackToItsHead) {
  Registry registry({.max_heads = 10, .resume_grace = 60}, pool_, pool_);
  TestStream first, second;
  const auto head = Open(registry, first, Pacing::kRealtime);
  ASSERT_TRUE(first.WaitForFrames(3));
  registry.Leave(head, &first);
  const uint64_t next = head->next_frame();
  second.Follow(head);
  const auto resumed = registry.Resume(token_, &second);
  ASSERT_TRUE(resumed);
  EXPECT_EQ(resumed->head, head);
  ASSERT_TRUE(second.WaitForFrames(1));
  // One that was being computed when the stream broke may have waited in the mailbox.
  EXPECT_GE(second.frames().front()->index + 2, next);
  EXPECT_FALSE(registry.Resume("no such token", &second));
  registry.Close(head, &second);
  const auto gone = registry.Resume(token_, &second);
  ASSERT_FALSE(gone);
  EXPECT_EQ(gone.error().code, ErrorCode::kNotFound);
}

TEST_F(RegistryTest, ResumingTakesTheHeadFromAStreamThatStillHoldsIt) {
  Registry registry({}, pool_, pool_);
  TestStream first, second;
  const auto head = Open(registry, first, Pacing::kRealtime);
  second.Follow(head);
  ASSERT_TRUE(registry.Resume(token_, &second));
  ASSERT_TRUE(first.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  EXPECT_EQ(first.end_->code, ErrorCode::kCancelled);
  registry.Leave(head, &first);  // Too late to matter.
  ASSERT_TRUE(second.WaitForFrames(2));
  registry.Close(head, &second);
}

TEST_F(RegistryTest, AStreamThatComesToAnEndedHeadIsTold) {
  const auto head = std::make_shared<HeadSession>("heads/1", groom_, HeadOptions(), pool_);
  head->End({ErrorCode::kUnavailable, "the server is stopping", ""});
  head->End({ErrorCode::kInternal, "too late", ""});
  TestStream stream;
  head->Attach(&stream);
  ASSERT_TRUE(stream.end_);
  EXPECT_EQ(stream.end_->code, ErrorCode::kUnavailable);
}

TEST_F(RegistryTest, HeadsWithoutAStreamExpire) {
  Registry registry({.max_heads = 10, .resume_grace = 0.01}, pool_, pool_);
  TestStream stream;
  const auto head = Open(registry, stream, Pacing::kRealtime);
  registry.Leave(head, &stream);
  const auto deadline = std::chrono::steady_clock::now() + seconds(20);
  while (registry.head_count() > 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_EQ(registry.head_count(), 0);
  EXPECT_FALSE(registry.Resume(token_, &stream));
  EXPECT_FALSE(head->Submit(Pose(1)));
}

TEST_F(RegistryTest, TheLimitRefusesButDetachedHeadsMakeRoom) {
  Registry registry({.max_heads = 2, .resume_grace = 60}, pool_, pool_);
  TestStream a, b, c;
  const auto first = Open(registry, a, Pacing::kLockstep);
  const auto second = Open(registry, b, Pacing::kRealtime);
  const auto refused = registry.Open(groom_, {}, "", &c);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  registry.Leave(second, &b);
  const auto third = Open(registry, c, Pacing::kLockstep);
  ASSERT_NE(third, nullptr);
  EXPECT_EQ(third->name(), "heads/3");  // What is refused is not built, and takes no name.
  EXPECT_EQ(registry.head_count(), 2);
  registry.Close(first, &a);
  registry.Close(third, &c);
  EXPECT_EQ(registry.head_count(), 0);
}

TEST_F(RegistryTest, RealtimeHeadsAreAdmittedByWhatTheyNeed) {
  // 12 guides of 4 elements and 16 points at 120 Hz need 257,280 element-steps a second: 48 a step,
  // 2000 a frame, 96 for its points.
  Registry registry({.max_heads = 10, .resume_grace = 60, .realtime_capacity = 600'000}, pool_,
                    pool_);
  TestStream a, b, c;
  const auto first = Open(registry, a, Pacing::kRealtime);
  const auto second = Open(registry, b, Pacing::kRealtime);
  const std::string second_token = token_;
  HeadOptions third;
  third.rate_hz = 120;
  const auto refused = registry.Open(groom_, third, "", &c);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  const auto lockstep = Open(registry, c, Pacing::kLockstep);  // Takes none of it.
  // A head that waits for its client keeps its share until it is gone.
  TestStream d;
  registry.Leave(second, &b);
  EXPECT_FALSE(registry.Open(groom_, third, "", &d));
  EXPECT_TRUE(registry.Resume(second_token, &b));
  registry.Close(first, &a);
  const auto again = Open(registry, a, Pacing::kRealtime);
  ASSERT_NE(again, nullptr);
  for (const auto& [head, stream] : {std::pair{second, &b}, {lockstep, &c}, {again, &a}}) {
    registry.Close(head, stream);
  }
}

TEST_F(RegistryTest, ALoadCountsStepsFramesAndPoints) {
  HeadOptions options;
  const auto load = [&] { return RealtimeLoad(*groom_, options); };
  EXPECT_DOUBLE_EQ(load(), 60 * (48 + 2000 + 12 * 16 / 2));
  options.view.points_per_guide = 256;
  EXPECT_DOUBLE_EQ(load(), 60 * (48 + 2000 + 12 * 256 / 2));
  options.view.format = head::FrameFormat::kGeneralized;
  EXPECT_DOUBLE_EQ(load(), 60 * (48 + 2000 + 48 / 2));
  options.substeps = 3;
  EXPECT_DOUBLE_EQ(load(), 60 * (48 * 3 + 2000 + 48 / 2));
  options.rate_hz = 2;  // Half a second takes thirty of the longest steps.
  EXPECT_DOUBLE_EQ(load(), 2 * (48 * 30 + 2000 + 48 / 2));
  options.pacing = Pacing::kLockstep;
  EXPECT_EQ(load(), 0);
}

TEST_F(RegistryTest, EightHeadsOfAHundredGuidesFitWithAmpleRoom) {
  EXPECT_LT(8 * RealtimeLoad(*head::SampleGroom(100, 5), {}),
            RegistryOptions().realtime_capacity / 5);
}

TEST_F(RegistryTest, FramesThatAreTooMuchWorkOrTooLargeAreRefused) {
  Registry registry({}, pool_, pool_);  // The groom has 48 elements.
  TestStream stream;
  const auto refused_field = [&](int substeps, int points) {
    HeadOptions options;
    options.pacing = Pacing::kLockstep;
    options.substeps = substeps;
    options.view.points_per_guide = points;
    const auto opened = registry.Open(groom_, options, "", &stream);
    EXPECT_FALSE(opened);
    return opened ? "" : opened.error().field;
  };
  EXPECT_EQ(refused_field(1'000'000, 16), "open.substeps");
  EXPECT_EQ(refused_field(1, 200'000), "open.points_per_guide");

  EXPECT_TRUE(AdmitFrame(*groom_, {{}, 1, 1}));
  const auto result = AdmitFrame(*groom_, {{}, 5000, 1});  // 300,000 of the longest steps.
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(result.error().field, "pose.time_s");
}

TEST_F(RegistryTest, AHeadOfLargeFramesHoldsFewerOfThem) {
  head::View view;
  EXPECT_EQ(FrameWindow(*groom_, view, 8), 8);
  view.points_per_guide = 50'000;  // 7.2 MB a frame: four of them in 32 MiB.
  EXPECT_EQ(FrameWindow(*groom_, view, 8), 4);
  EXPECT_EQ(FrameWindow(*groom_, view, 3), 3);
  view.points_per_guide = 1'000'000;  // More than are admitted.
  EXPECT_EQ(FrameWindow(*groom_, view, 8), 1);

  Registry registry({}, pool_, pool_);
  TestStream lockstep, realtime;
  HeadOptions options;
  options.view.points_per_guide = 100'000;  // 14.4 MB: two.
  options.max_unacked = 16;
  options.rate_hz = 10;
  const auto newest = registry.Open(groom_, options, "", &realtime);
  ASSERT_TRUE(newest);
  realtime.Follow(newest->head);
  options.pacing = Pacing::kLockstep;
  const auto ordered = registry.Open(groom_, options, "", &lockstep);
  ASSERT_TRUE(ordered);
  for (int i = 0; i < 2; ++i) {
    EXPECT_FALSE(ordered->head->Full());
    ASSERT_TRUE(ordered->head->Submit(Pose(i)));
  }
  EXPECT_TRUE(ordered->head->Full());
  lockstep.Follow(ordered->head);
  lockstep.OnProgress();
  ASSERT_TRUE(lockstep.WaitForFrames(2));
  const auto deadline = std::chrono::steady_clock::now() + seconds(20);
  while (newest->head->next_frame() < 5 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_GE(newest->head->next_frame(), 5u);
  EXPECT_EQ(realtime.frames().size(), 2u);
  registry.Close(newest->head, &realtime);
  registry.Close(ordered->head, &lockstep);
}

TEST_F(RegistryTest, ASlowRateMovesHairAllTheSame) {
  Registry registry({}, pool_, pool_);
  TestStream stream;
  HeadOptions options;
  options.rate_hz = 1.5;
  const auto opened = registry.Open(groom_, options, "", &stream);
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

TEST_F(RegistryTest, AStoppingServerAdmitsNobody) {
  Registry registry({}, pool_, pool_);
  TestStream first, second;
  const auto head = Open(registry, first, Pacing::kRealtime);
  EXPECT_EQ(registry.attached_count(), 1);
  registry.Leave(head, &first);
  EXPECT_EQ(registry.attached_count(), 0);
  registry.StopAdmitting();
  EXPECT_EQ(registry.Open(groom_, {}, "", &second).error().code, ErrorCode::kUnavailable);
  EXPECT_EQ(registry.Resume(token_, &second).error().code, ErrorCode::kUnavailable);
}

TEST_F(RegistryTest, OpeningAgainWithARequestIdReplacesTheLostTry) {
  Registry registry({}, pool_, pool_);
  TestStream lost, again;
  Open(registry, lost, Pacing::kRealtime, "try-1");
  const auto head = Open(registry, again, Pacing::kRealtime, "try-1");
  ASSERT_TRUE(lost.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  EXPECT_EQ(registry.head_count(), 1);
  ASSERT_TRUE(again.WaitForFrames(2));
  registry.Close(head, &again);
}

TEST_F(RegistryTest, AReplacementThatIsRefusedLeavesTheOldHeadAlone) {
  HeadOptions options;
  options.rate_hz = 120;
  const double load = RealtimeLoad(*groom_, options);
  Registry registry({.max_heads = 1, .resume_grace = 60, .realtime_capacity = 1.5 * load}, pool_,
                    pool_);
  TestStream first, second, third;
  const auto head = Open(registry, first, Pacing::kRealtime, "try-1");
  options.rate_hz = 240;
  const auto refused = registry.Open(groom_, options, "try-1", &second);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(registry.head_count(), 1);
  EXPECT_FALSE(first.end_);
  const uint64_t last = head->next_frame() + 3;
  ASSERT_TRUE(first.WaitFor([&](const TestStream& s) {  // It goes on,
    return !s.frames_.empty() && head->Acknowledge(s.frames_.back()->index) &&
           s.frames_.back()->index >= last;
  }));
  // and an equal one takes its place, as what leaves needs nothing more.
  const auto replacement = Open(registry, third, Pacing::kRealtime, "try-1");
  ASSERT_NE(replacement, nullptr);
  ASSERT_TRUE(first.WaitFor([](const TestStream& s) { return s.end_.has_value(); }));
  registry.Close(replacement, &third);
}

TEST_F(RegistryTest, AFaultEndsOneHeadAndNoOther) {
  Registry registry({}, pool_, pool_);
  TestStream sick, well;
  HeadOptions bad;  // Validation keeps such a view out; here it stands for a fault of the program.
  bad.pacing = Pacing::kLockstep;
  bad.view.points_per_guide = 1;
  const auto broken = registry.Open(groom_, bad, "", &sick)->head;
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

TEST_F(RegistryTest, ManyStreamsComeAndGoAtOnce) {
  Registry registry({.max_heads = 64, .resume_grace = 0.02}, pool_, pool_);
  std::vector<std::jthread> clients;
  for (int c = 0; c < 6; ++c) {
    clients.emplace_back([&, c] {
      for (int round = 0; round < 15; ++round) {
        TestStream stream;
        HeadOptions options;
        options.pacing = (c + round) % 2 == 0 ? Pacing::kRealtime : Pacing::kLockstep;
        options.rate_hz = 240;
        const auto opened = registry.Open(groom_, options, "", &stream);
        ASSERT_TRUE(opened);
        stream.Follow(opened->head);
        for (int i = 0; i < 4; ++i) ASSERT_TRUE(opened->head->Submit(Pose(i)));
        ASSERT_TRUE(stream.WaitForFrames(2));
        if (round % 3 == 0) {
          registry.Leave(opened->head, &stream);  // The expiry races with what comes.
        } else {
          registry.Close(opened->head, &stream);
        }
      }
    });
  }
  clients.clear();
  const auto deadline = std::chrono::steady_clock::now() + seconds(20);
  while (registry.head_count() > 0 && std::chrono::steady_clock::now() < deadline) {
    std::this_thread::yield();
  }
  EXPECT_EQ(registry.head_count(), 0);
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
