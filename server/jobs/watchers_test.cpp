// Properties of watching a job:
//   first and last   the callback sees the job as it is, then how it ends, however it ends
//   order            states and progress only move forward; nothing comes after the end
//   rate             faster changes than ten a second are merged
//   unsubscribing    waits for a running callback, also under load, and works inside it

#include "jobs/watchers.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <optional>
#include <vector>

#include "jobs/test_queue.h"

namespace mane::jobs {
namespace {

using storage::JobRecord;

// What a callback was told.
class Log {
 public:
  Watchers::Callback Callback() {
    return [this](const Result<JobStatus>& status) {
      std::lock_guard lock(mutex_);
      if (status) {
        seen_.push_back(status->job);
      } else {
        error_ = status.error();
      }
    };
  }

  std::vector<JobRecord> Seen() {
    std::lock_guard lock(mutex_);
    return seen_;
  }
  std::optional<Error> error() {
    std::lock_guard lock(mutex_);
    return error_;
  }
  bool SawEnd() {
    const auto seen = Seen();
    return !seen.empty() && storage::HasEnded(seen.back().state);
  }

 private:
  std::mutex mutex_;
  std::vector<JobRecord> seen_;
  std::optional<Error> error_;
};

using WatchTest = QueueTest;

TEST_F(WatchTest, SeesTheJobNowAndHowItEnds) {
  std::atomic<bool> finish = false;
  queue_->RegisterRunner("work", [&](const JobRecord&, JobContext& context) -> Result<void> {
    for (int i = 1; !finish && !context.Cancelled(); ++i) {
      context.Progress(1 - 1.0 / i);
      std::this_thread::yield();
    }
    return {};
  });
  const std::string id = Submit("work");
  Log log;
  const auto subscription = queue_->Watch(id, log.Callback());
  ASSERT_TRUE(Eventually([&] { return !log.Seen().empty(); }));
  EXPECT_EQ(log.Seen().front().state, JobState::kQueued);
  MANE_ASSERT_OK(queue_->Start());
  ASSERT_TRUE(Eventually([&] { return log.Seen().back().progress > 0; }));
  EXPECT_EQ(log.Seen().back().state, JobState::kRunning);
  finish = true;
  ASSERT_TRUE(Eventually([&] { return log.SawEnd(); }));
  const auto seen = log.Seen();
  EXPECT_EQ(seen.back(), Get(id).job);
  for (size_t i = 1; i < seen.size(); ++i) {
    EXPECT_GE(seen[i].state, seen[i - 1].state);
    EXPECT_GE(seen[i].progress, seen[i - 1].progress);
  }
}

TEST_F(WatchTest, SeesEveryKindOfEnd) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  queue_->RegisterRunner("succeed", [](const JobRecord&, JobContext&) { return Result<void>(); });
  queue_->RegisterRunner("fail", [](const JobRecord&, JobContext&) -> Result<void> {
    return Error{ErrorCode::kInternal, "why", ""};
  });
  const std::string cancelled_queued = Submit("succeed");
  const std::string succeeded = Submit("succeed");
  const std::string failed = Submit("fail");
  const std::string cancelled_running = Submit("stay");
  Log logs[5];
  std::vector<Subscription> subscriptions;
  const std::string ids[] = {cancelled_queued, succeeded, failed, cancelled_running};
  for (int i = 0; i < 4; ++i) subscriptions.push_back(queue_->Watch(ids[i], logs[i].Callback()));
  MANE_ASSERT_OK(queue_->Cancel(cancelled_queued));
  MANE_ASSERT_OK(queue_->Start());
  ASSERT_TRUE(Reaches(cancelled_running, JobState::kRunning));
  MANE_ASSERT_OK(queue_->Cancel(cancelled_running));
  for (int i = 0; i < 4; ++i) ASSERT_TRUE(Eventually([&] { return logs[i].SawEnd(); })) << i;
  EXPECT_EQ(logs[0].Seen().back().state, JobState::kCancelled);
  EXPECT_EQ(logs[1].Seen().back().state, JobState::kSucceeded);
  EXPECT_EQ(logs[2].Seen().back().state, JobState::kFailed);
  EXPECT_EQ(logs[2].Seen().back().error, "why");
  EXPECT_EQ(logs[3].Seen().back().state, JobState::kCancelled);

  // One that has ended is shown once.
  subscriptions.push_back(queue_->Watch(failed, logs[4].Callback()));
  ASSERT_TRUE(Eventually([&] { return logs[4].SawEnd(); }));
  EXPECT_EQ(logs[4].Seen().size(), 1u);
}

TEST_F(WatchTest, UnknownJobIsNotFound) {
  Log log;
  const auto subscription = queue_->Watch("nobody", log.Callback());
  ASSERT_TRUE(Eventually([&] { return log.error().has_value(); }));
  EXPECT_EQ(log.error()->code, ErrorCode::kNotFound);
}

// A Watchers without a queue: the reader counts.
class WatchersTest : public ::testing::Test {
 protected:
  Result<JobStatus> Read(const std::string& id) {
    JobStatus status;
    status.job.id = id;
    status.job.state = JobState::kRunning;
    status.job.result_bytes = version_;
    return status;
  }

  std::atomic<int64_t> version_ = 0;
  Watchers watchers_{[this](const std::string& id) { return Read(id); }};
};

TEST_F(WatchersTest, ManyChangesAreMergedAndTheLastIsSeen) {
  Log log;
  const auto start = std::chrono::steady_clock::now();
  const auto subscription = watchers_.Watch("job", log.Callback());
  constexpr int kChanges = 20'000;
  for (int i = 0; i < kChanges; ++i) {
    ++version_;
    watchers_.Changed("job");
  }
  ASSERT_TRUE(Eventually([&] {
    const auto seen = log.Seen();
    return !seen.empty() && seen.back().result_bytes == kChanges;
  }));
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
  EXPECT_LE(log.Seen().size(), static_cast<size_t>(took.count() / 0.1) + 1);
}

TEST_F(WatchersTest, OnlySubscribersOfTheJobAreCalled) {
  Log one, other;
  const auto first = watchers_.Watch("one", one.Callback());
  const auto second = watchers_.Watch("other", other.Callback());
  ASSERT_TRUE(Eventually([&] { return !one.Seen().empty() && !other.Seen().empty(); }));
  version_ = 1;
  watchers_.Changed("one");
  ASSERT_TRUE(Eventually([&] { return one.Seen().size() == 2; }));
  EXPECT_EQ(one.Seen().back().id, "one");
  EXPECT_EQ(other.Seen().size(), 1u);
}

TEST_F(WatchersTest, UnsubscribingWaitsForTheRunningCallback) {
  std::atomic<bool> inside = false, leave = false, done = false;
  auto subscription = watchers_.Watch("job", [&](const Result<JobStatus>&) {
    inside = true;
    while (!leave) std::this_thread::yield();
    done = true;
  });
  ASSERT_TRUE(Eventually([&] { return inside.load(); }));
  std::atomic<bool> unsubscribed = false;
  std::jthread thread([&] {
    subscription.Reset();
    EXPECT_TRUE(done);
    unsubscribed = true;
  });
  EXPECT_FALSE(unsubscribed);
  leave = true;
  thread.join();
  EXPECT_TRUE(unsubscribed);
}

TEST_F(WatchersTest, UnsubscribingWorksInsideTheCallback) {
  std::mutex mutex;
  Subscription subscription;
  std::atomic<int> calls = 0;
  {
    std::lock_guard lock(mutex);
    subscription = watchers_.Watch("job", [&](const Result<JobStatus>&) {
      std::lock_guard in_callback(mutex);
      subscription.Reset();
      ++calls;
    });
  }
  ASSERT_TRUE(Eventually([&] { return calls == 1; }));
  Log log;
  watchers_.Changed("job");
  const auto next = watchers_.Watch("job", log.Callback());
  ASSERT_TRUE(Eventually([&] { return !log.Seen().empty(); }));
  EXPECT_EQ(calls, 1);
}

// Each callback touches what its owner destroys right after it has unsubscribed.
TEST_F(WatchersTest, NoCallbackAfterUnsubscribingUnderLoad) {
  std::atomic<bool> stop = false;
  std::jthread publisher([&] {
    while (!stop) {
      watchers_.Changed("job");
      std::this_thread::yield();
    }
  });
  std::vector<std::jthread> owners;
  for (int t = 0; t < 3; ++t) {
    owners.emplace_back([&] {
      for (int i = 0; i < 300; ++i) {
        auto owned = std::make_unique<std::atomic<int>>(0);
        {
          const auto subscription =
              watchers_.Watch("job", [&owned](const Result<JobStatus>&) { ++*owned; });
          if (i % 3 == 0) Eventually([&] { return *owned > 0; });
        }
        owned.reset();
      }
    });
  }
  owners.clear();
  stop = true;
}

TEST_F(WatchersTest, ThrowingCallbackHarmsNoOther) {
  std::atomic<int> calls = 0;
  const auto bad = watchers_.Watch("job", [&](const Result<JobStatus>&) {
    ++calls;
    throw std::runtime_error("oops");
  });
  ASSERT_TRUE(Eventually([&] { return calls == 1; }));
  Log log;
  const auto good = watchers_.Watch("job", log.Callback());
  watchers_.Changed("job");
  EXPECT_TRUE(Eventually([&] { return !log.Seen().empty(); }));
  EXPECT_EQ(calls, 1);
}

TEST(SubscriptionTest, MayOutliveTheWatchers) {
  Subscription subscription;
  {
    Watchers watchers([](const std::string&) { return Result<JobStatus>(JobStatus()); });
    subscription = watchers.Watch("job", [](const Result<JobStatus>&) {});
  }
  subscription.Reset();
  Subscription moved = std::move(subscription);
}

}  // namespace
}  // namespace mane::jobs
