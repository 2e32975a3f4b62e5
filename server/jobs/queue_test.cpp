// Properties of the queue while it runs:
//   order        oldest first, on one worker one at a time, on several at once
//   outcome      success, failure, exception and failed check each end their own job only
//   cancel       ends a queued job at once and a running one soon; racing the end, one of them wins
//   progress     rises only, is seen at once, and is 1 at the end
//   limits       unknown kinds, too many waiting jobs and options out of range are refused

#include "jobs/queue.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <vector>

#include "jobs/test_queue.h"

namespace mane::jobs {
namespace {

using storage::JobRecord;

TEST_F(QueueTest, OneWorkerRunsJobsOneByOneInOrder) {
  std::mutex mutex;
  std::vector<std::string> order;
  std::atomic<int> running = 0, most = 0;
  queue_->RegisterRunner("note", [&](const JobRecord&, JobContext& context) {
    most = std::max(most.load(), ++running);
    {
      std::lock_guard lock(mutex);
      order.push_back(context.spec());
    }
    --running;
    return Result<void>();
  });
  const std::vector<std::string> specs = {"c", "a", "d", "b"};
  for (size_t i = 0; i < 2; ++i) Submit("note", specs[i]);
  MANE_ASSERT_OK(queue_->Start());
  Submit("note", specs[2]);
  const std::string last = Submit("note", specs[3]);
  ASSERT_TRUE(Reaches(last, JobState::kSucceeded));
  std::lock_guard lock(mutex);
  EXPECT_EQ(order, specs);
  EXPECT_EQ(most, 1);
}

TEST_F(QueueTest, SeveralWorkersRunJobsAtOnce) {
  QueueOptions options;
  options.workers = 3;
  NewQueue(options);
  std::atomic<int> running = 0;
  queue_->RegisterRunner("meet", [&](const JobRecord&, JobContext& context) -> Result<void> {
    ++running;
    if (Eventually([&] { return running == 3 || context.Cancelled(); })) return {};
    return Error{ErrorCode::kInternal, "met nobody", ""};
  });
  MANE_ASSERT_OK(queue_->Start());
  for (int i = 0; i < 3; ++i) Submit("meet");
  EXPECT_TRUE(Eventually([&] {
    const auto page = queue_->List(10, "");
    return page && std::all_of(page->records.begin(), page->records.end(), [](const auto& status) {
             return status.job.state == JobState::kSucceeded;
           });
  }));
}

TEST_F(QueueTest, IdleWorkerWakesForAJob) {
  queue_->RegisterRunner("succeed", [](const JobRecord&, JobContext&) { return Result<void>(); });
  MANE_ASSERT_OK(queue_->Start());
  for (int i = 0; i < 5; ++i) {
    const std::string id = Submit("succeed");
    ASSERT_TRUE(Reaches(id, JobState::kSucceeded)) << i;
    // The worker takes turns with these at the store, finds nothing, and goes idle.
    for (int k = 0; k < 300; ++k) Get(id);
  }
}

TEST_F(QueueTest, SubmittedJobIsOnDiskAndRepeatsReturnIt) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  const std::string id = Submit("stay", "spec", "request");
  auto other = storage::JobStore::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(other);
  const auto stored = (*other)->Get(id);
  MANE_ASSERT_OK(stored);
  EXPECT_EQ(stored->kind, "stay");
  EXPECT_EQ(stored->description, "about it");
  EXPECT_EQ(Submit("stay", "spec", "request"), id);
  MANE_ASSERT_OK(queue_->Start());
  ASSERT_TRUE(Reaches(id, JobState::kRunning));
  EXPECT_EQ(Submit("stay", "spec", "request"), id);
  EXPECT_NE(Submit("stay", "spec"), id);
}

TEST_F(QueueTest, SimultaneousRepeatsMakeOneJob) {
  std::atomic<int> runs = 0;
  queue_->RegisterRunner("count", [&](const JobRecord&, JobContext&) {
    ++runs;
    return Result<void>();
  });
  MANE_ASSERT_OK(queue_->Start());
  std::vector<std::string> ids(4);
  {
    std::vector<std::jthread> threads;
    for (auto& id : ids) threads.emplace_back([&] { id = Submit("count", "", "request"); });
  }
  for (const auto& id : ids) EXPECT_EQ(id, ids[0]);
  ASSERT_TRUE(Reaches(ids[0], JobState::kSucceeded));
  const auto page = queue_->List(10, "");
  MANE_ASSERT_OK(page);
  EXPECT_EQ(page->records.size(), 1u);
  queue_->Stop();
  EXPECT_EQ(runs, 1);
}

TEST_F(QueueTest, JobFailsAloneAndSaysWhy) {
  queue_->RegisterRunner("fail", [](const JobRecord&, JobContext&) -> Result<void> {
    return InvalidArgument("motion", "motion has 0 poses");
  });
  queue_->RegisterRunner("throw", [](const JobRecord&, JobContext&) -> Result<void> {
    throw std::runtime_error("out of luck");
  });
  queue_->RegisterRunner("throw-number",
                         [](const JobRecord&, JobContext&) -> Result<void> { throw 7; });
  queue_->RegisterRunner("check", [](const JobRecord& job, JobContext&) -> Result<void> {
    MANE_CHECK(job.kind.empty());
    return {};
  });
  queue_->RegisterRunner("give-up", [](const JobRecord&, JobContext&) -> Result<void> {
    return JobContext::StoppedError();  // Though nobody asked.
  });
  queue_->RegisterRunner("succeed", [](const JobRecord&, JobContext& context) {
    return context.AppendResult("chunk");
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"fail", "motion: motion has 0 poses"},
      {"throw", "internal fault: out of luck"},
      {"throw-number", "internal fault: an exception"},
      {"check", "check failed: job.kind.empty()"},
      {"give-up", "the job was stopped"}};
  for (const auto& [kind, why] : cases) {
    const std::string id = Submit(kind);
    ASSERT_TRUE(Reaches(id, JobState::kFailed)) << kind;
    EXPECT_NE(Get(id).job.error.find(why), std::string::npos) << Get(id).job.error;
  }
  const std::string id = Submit("succeed");
  ASSERT_TRUE(Reaches(id, JobState::kSucceeded));
  EXPECT_EQ(Get(id).job.error, "");
  EXPECT_EQ(Get(id).job.result_bytes, 5);
  EXPECT_EQ(*store_->ReadResult(id, 0), "chunk");
}

TEST_F(QueueTest, CancelledInTheQueueNeverRuns) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  queue_->RegisterRunner("fail", [](const JobRecord&, JobContext&) -> Result<void> {
    return Error{ErrorCode::kInternal, "it ran", ""};
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::string first = Submit("stay");
  const std::string second = Submit("fail");
  ASSERT_TRUE(Reaches(first, JobState::kRunning));
  const auto cancelled = queue_->Cancel(second);
  MANE_ASSERT_OK(cancelled);
  EXPECT_EQ(cancelled->job.state, JobState::kCancelled);
  MANE_ASSERT_OK(queue_->Cancel(first));
  ASSERT_TRUE(Reaches(first, JobState::kCancelled));
  EXPECT_EQ(Get(second).job.state, JobState::kCancelled);
}

TEST_F(QueueTest, RunningJobIsCancelledSoonAndLeavesNoResult) {
  std::atomic<bool> appended = false;
  queue_->RegisterRunner("append", [&](const JobRecord&, JobContext& context) -> Result<void> {
    while (true) {
      if (auto done = context.AppendResult("chunk"); !done) return done;  // Stops by itself.
      appended = true;
    }
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::string id = Submit("append");
  ASSERT_TRUE(Eventually([&] { return appended.load(); }));
  MANE_ASSERT_OK(queue_->Cancel(id));
  ASSERT_TRUE(Reaches(id, JobState::kCancelled));
  EXPECT_EQ(Get(id).job.error, "");
  EXPECT_EQ(Get(id).job.result_chunks, 0);
  EXPECT_FALSE(store_->ReadResult(id, 0));
  const auto again = queue_->Cancel(id);
  MANE_ASSERT_OK(again);
  EXPECT_EQ(again->job.state, JobState::kCancelled);
}

// Whichever comes first, the job ends once, its answer is final, and the worker goes on.
TEST_F(QueueTest, CancelRacingTheEndHasOneOutcome) {
  std::atomic<bool> go = false;
  queue_->RegisterRunner("end", [&](const JobRecord&, JobContext& context) -> Result<void> {
    while (!go) std::this_thread::yield();
    if (context.Cancelled()) return JobContext::StoppedError();
    return {};
  });
  MANE_ASSERT_OK(queue_->Start());
  for (int i = 0; i < 50; ++i) {
    go = false;
    const std::string id = Submit("end");
    // Every other time the cancel also races the claim.
    if (i % 2 == 0) {
      ASSERT_TRUE(Reaches(id, JobState::kRunning));
    }
    std::jthread canceller([&] { MANE_EXPECT_OK(queue_->Cancel(id)); });
    go = true;
    ASSERT_TRUE(Eventually([&] { return storage::HasEnded(Get(id).job.state); }));
    canceller.join();
    const JobStatus ended = Get(id);
    EXPECT_TRUE(ended.job.state == JobState::kSucceeded || ended.job.state == JobState::kCancelled);
    EXPECT_EQ(ended.job.error, "");
    EXPECT_EQ(Get(id).job, ended.job);
  }
}

// Were the cancel lost between the claim and the runner's start, the job would run for ever.
TEST_F(QueueTest, CancelRacingTheClaimIsNeverLost) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  MANE_ASSERT_OK(queue_->Start());
  for (int i = 0; i < 50; ++i) {
    const std::string id = Submit("stay");
    MANE_ASSERT_OK(queue_->Cancel(id));
    ASSERT_TRUE(Reaches(id, JobState::kCancelled)) << i;
  }
}

TEST_F(QueueTest, ProgressOnlyRises) {
  std::atomic<int> told = 0, seen = 0;
  const std::vector<double> fractions = {0.25, 0.1, std::nan(""), -1, 0.5, 0.5, 7, 0.9};
  queue_->RegisterRunner("tell", [&](const JobRecord&, JobContext& context) -> Result<void> {
    for (size_t i = 0; i < fractions.size(); ++i) {
      context.Progress(fractions[i]);
      ++told;
      if (!Eventually([&] { return seen == told || context.Cancelled(); })) break;
    }
    return {};
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::string id = Submit("tell");
  const std::vector<double> expected = {0.25, 0.25, 0.25, 0.25, 0.5, 0.5, 1, 1};
  for (size_t i = 0; i < expected.size(); ++i) {
    ASSERT_TRUE(Eventually([&] { return told == static_cast<int>(i) + 1; }));
    const JobStatus status = Get(id);
    EXPECT_EQ(status.job.state, JobState::kRunning);
    EXPECT_EQ(status.job.progress, expected[i]);
    if (status.job.progress < 1) {
      EXPECT_GT(status.seconds_left, 0);
    } else {
      EXPECT_EQ(status.seconds_left, 0);
    }
    const auto page = queue_->List(1, "");
    MANE_ASSERT_OK(page);
    EXPECT_EQ(page->records.at(0).job.progress, expected[i]);
    ++seen;
  }
  ASSERT_TRUE(Reaches(id, JobState::kSucceeded));
  EXPECT_EQ(Get(id).job.progress, 1);
  EXPECT_EQ(Get(id).seconds_left, 0);
}

TEST_F(QueueTest, ProgressOfSeveralThreadsNeverFalls) {
  queue_->RegisterRunner("tell", [](const JobRecord&, JobContext& context) -> Result<void> {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 3; ++t) {
      threads.emplace_back([&] {
        for (int i = 1; i <= 5000; ++i) context.Progress(i / 5000.0);
      });
    }
    return {};
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::string id = Submit("tell");
  double last = 0;
  ASSERT_TRUE(Eventually([&] {
    const JobStatus status = Get(id);
    EXPECT_GE(status.job.progress, last);
    last = status.job.progress;
    return status.job.state == JobState::kSucceeded;
  }));
  EXPECT_EQ(last, 1);
}

TEST_F(QueueTest, UnknownKindAndFullQueueAreRefused) {
  QueueOptions options;
  options.max_queued = 2;
  NewQueue(options);
  queue_->RegisterRunner("stay", RunUntilStopped);
  const auto unknown = queue_->Submit({"style", "", "", ""});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(unknown.error().field, "kind");
  EXPECT_NE(unknown.error().message.find("style"), std::string::npos);
  Submit("stay");
  Submit("stay");
  const auto full = queue_->Submit({"stay", "", "", ""});
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kResourceExhausted);
}

TEST_F(QueueTest, OnlyAnEndedJobCanBeDeleted) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  MANE_ASSERT_OK(queue_->Start());
  const std::string id = Submit("stay");
  ASSERT_TRUE(Reaches(id, JobState::kRunning));
  EXPECT_EQ(queue_->Delete(id).error().code, ErrorCode::kFailedPrecondition);
  MANE_ASSERT_OK(queue_->Cancel(id));
  ASSERT_TRUE(Reaches(id, JobState::kCancelled));
  MANE_ASSERT_OK(queue_->Delete(id));
  EXPECT_EQ(queue_->Get(id).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(queue_->Cancel(id).error().code, ErrorCode::kNotFound);
}

TEST_F(QueueTest, OldEndedJobsMakeRoom) {
  QueueOptions options;
  options.max_ended = 3;
  NewQueue(options);
  queue_->RegisterRunner("succeed", [](const JobRecord&, JobContext&) { return Result<void>(); });
  MANE_ASSERT_OK(queue_->Start());
  std::vector<std::string> ids;
  for (int i = 0; i < 6; ++i) ids.push_back(Submit("succeed"));
  ASSERT_TRUE(Eventually([&] {
    const auto page = queue_->List(10, "");
    return page && page->records.size() == 3 && Get(ids[5]).job.state == JobState::kSucceeded;
  }));
  for (int i = 0; i < 6; ++i) EXPECT_EQ(queue_->Get(ids[i]).has_value(), i >= 3);
}

TEST(QueueOptionsTest, ValueOutOfRangeIsNamed) {
  EXPECT_TRUE(QueueOptions().Validate());
  const auto expect_refused = [](const QueueOptions& options, const std::string& field) {
    const auto checked = options.Validate();
    ASSERT_FALSE(checked);
    EXPECT_EQ(checked.error().code, ErrorCode::kInvalidArgument);
    EXPECT_EQ(checked.error().field, field);
  };
  for (const int value : {-1, 0, std::numeric_limits<int>::max()}) {
    QueueOptions options;
    options.workers = value;
    expect_refused(options, "workers");
    options = {};
    options.max_queued = value;
    expect_refused(options, "max_queued");
    options = {};
    options.max_ended = value;
    expect_refused(options, "max_ended");
  }
}

}  // namespace
}  // namespace mane::jobs
