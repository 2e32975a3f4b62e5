// Properties of the queue across stops, restarts and a failing store: no job is lost, none is left
// running, an interrupted one starts over without its partial result.

#include <gtest/gtest.h>

#include <atomic>
#include <vector>

#include "jobs/queue.h"
#include "jobs/test_queue.h"
#include "storage/database.h"

namespace mane::jobs {
namespace {

using storage::JobRecord;

TEST_F(QueueTest, JobInterruptedByADeathStartsOver) {
  // As a server leaves it that dies: claimed, with a partial result, and never finished.
  MANE_ASSERT_OK(store_->Insert({"job", "", "write", "", "spec"}, 10));
  MANE_ASSERT_OK(store_->ClaimNext());
  MANE_ASSERT_OK(store_->AppendResult("job", 0, "partial"));
  MANE_ASSERT_OK(store_->SetProgress("job", 0.5));

  queue_->RegisterRunner("write", [](const JobRecord& job, JobContext& context) -> Result<void> {
    MANE_CHECK(job.result_chunks == 0 && job.progress == 0);
    return context.AppendResult(context.spec());
  });
  MANE_ASSERT_OK(queue_->Start());
  ASSERT_TRUE(Reaches("job", JobState::kSucceeded)) << Get("job").job.error;
  EXPECT_EQ(Get("job").job.result_chunks, 1);
  EXPECT_EQ(*store_->ReadResult("job", 0), "spec");
}

TEST_F(QueueTest, StopLeavesTheRunningJobQueuedAndStartRunsItAgain) {
  std::atomic<int> runs = 0;
  std::atomic<bool> finish = false;
  queue_->RegisterRunner("work", [&](const JobRecord&, JobContext& context) -> Result<void> {
    if (auto done = context.AppendResult("chunk"); !done) return done;
    context.Progress(0.5);
    ++runs;
    while (!context.Cancelled()) {
      if (finish) return {};
      std::this_thread::yield();
    }
    return JobContext::StoppedError();
  });
  const std::string first = Submit("work");
  const std::string second = Submit("work");
  for (int round = 1; round <= 3; ++round) {
    MANE_ASSERT_OK(queue_->Start());
    ASSERT_TRUE(Eventually([&] { return runs == round; }));
    queue_->Stop();
    for (const auto& id : {first, second}) {
      EXPECT_EQ(Get(id).job.state, JobState::kQueued);
      EXPECT_EQ(Get(id).job.progress, 0);
      EXPECT_EQ(Get(id).job.result_chunks, 0);
    }
  }
  finish = true;
  MANE_ASSERT_OK(queue_->Start());
  EXPECT_TRUE(Reaches(first, JobState::kSucceeded));
  EXPECT_TRUE(Reaches(second, JobState::kSucceeded));
  EXPECT_EQ(Get(first).job.result_chunks, 1);
}

TEST_F(QueueTest, JobThatEndsWhileStoppingHasEnded) {
  std::atomic<bool> running = false;
  queue_->RegisterRunner("end", [&](const JobRecord&, JobContext& context) -> Result<void> {
    running = true;
    while (!context.Cancelled()) std::this_thread::yield();
    return {};
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::string id = Submit("end");
  ASSERT_TRUE(Eventually([&] { return running.load(); }));
  queue_->Stop();
  EXPECT_EQ(Get(id).job.state, JobState::kSucceeded);
}

TEST_F(QueueTest, CancelIsStrongerThanStop) {
  std::atomic<bool> running = false, leave = false;
  queue_->RegisterRunner("linger", [&](const JobRecord&, JobContext& context) -> Result<void> {
    running = true;
    while (!context.Cancelled() || !leave) std::this_thread::yield();
    return JobContext::StoppedError();
  });
  for (const bool cancel_first : {true, false}) {
    running = leave = false;
    MANE_ASSERT_OK(queue_->Start());
    const std::string id = Submit("linger");
    ASSERT_TRUE(Eventually([&] { return running.load(); }));
    if (cancel_first) {
      MANE_ASSERT_OK(queue_->Cancel(id));
    }
    std::jthread stopper([&] { queue_->Stop(); });
    if (!cancel_first) {
      MANE_ASSERT_OK(queue_->Cancel(id));
    }
    leave = true;
    stopper.join();
    EXPECT_EQ(Get(id).job.state, JobState::kCancelled);
  }
}

TEST_F(QueueTest, StoppedQueueTakesReadsAndCancelsJobs) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  queue_->Stop();  // Harmless before Start.
  MANE_ASSERT_OK(queue_->Start());
  queue_->Stop();
  queue_->Stop();
  const std::string id = Submit("stay");
  EXPECT_EQ(Get(id).job.state, JobState::kQueued);
  MANE_ASSERT_OK(queue_->Cancel(id));
  EXPECT_EQ(Get(id).job.state, JobState::kCancelled);
}

TEST_F(QueueTest, StopWhileJobsComeAndGoLosesNone) {
  QueueOptions options;
  options.workers = 2;
  NewQueue(options);
  queue_->RegisterRunner("quick", [](const JobRecord&, JobContext& context) -> Result<void> {
    if (context.Cancelled()) return JobContext::StoppedError();
    return context.AppendResult("chunk");
  });
  std::vector<std::string> ids(40);
  {
    std::jthread submitter([&] {
      for (auto& id : ids) id = Submit("quick");
    });
    for (int i = 0; i < 10; ++i) {
      MANE_EXPECT_OK(queue_->Start());
      queue_->Stop();
    }
  }
  MANE_ASSERT_OK(queue_->Start());
  for (const auto& id : ids) {
    ASSERT_TRUE(Reaches(id, JobState::kSucceeded));
    EXPECT_EQ(Get(id).job.result_chunks, 1);
  }
}

// Were the stop lost between the claim and the runner's start, the job would run on and fail.
TEST_F(QueueTest, StopRacingTheClaimIsNeverLost) {
  queue_->RegisterRunner("stay", RunUntilStopped);
  const std::string id = Submit("stay");
  for (int i = 0; i < 50; ++i) {
    MANE_ASSERT_OK(queue_->Start());
    // Claimed, by what the store says: the worker may not have got further.
    const auto claimed = [&] { return store_->Get(id)->state == JobState::kRunning; };
    ASSERT_TRUE(i % 2 == 0 || Eventually(claimed));
    queue_->Stop();
    ASSERT_EQ(Get(id).job.state, JobState::kQueued) << i;
  }
}

TEST_F(QueueTest, QueuedJobWithoutARunnerFails) {
  queue_->RegisterRunner("old", RunUntilStopped);
  const std::string id = Submit("old");
  NewQueue();
  MANE_ASSERT_OK(queue_->Start());
  ASSERT_TRUE(Reaches(id, JobState::kFailed));
  EXPECT_NE(Get(id).job.error.find("`old`"), std::string::npos);
}

// A store that fails for a while delays a job's end, but neither loses it nor ends the worker.
TEST_F(QueueTest, WorkerOutlivesAFailingStore) {
  auto saboteur = storage::Database::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(saboteur);
  std::atomic<bool> running = false, finish = false;
  queue_->RegisterRunner("work", [&](const JobRecord&, JobContext& context) -> Result<void> {
    running = true;
    while (!finish && !context.Cancelled()) std::this_thread::yield();
    return {};
  });
  MANE_ASSERT_OK(queue_->Start());
  const std::string first = Submit("work");
  ASSERT_TRUE(Eventually([&] { return running.load(); }));
  // Every change of a job fails from now on.
  MANE_ASSERT_OK(saboteur->RunScript(
      "CREATE TRIGGER sabotage BEFORE UPDATE ON jobs BEGIN SELECT raise(ABORT, 'broken'); END"));
  finish = true;
  const std::string second = Submit("work");
  EXPECT_EQ(queue_->Cancel(first).error().code, ErrorCode::kInternal);
  EXPECT_EQ(Get(first).job.state, JobState::kRunning);
  MANE_ASSERT_OK(saboteur->RunScript("DROP TRIGGER sabotage"));
  EXPECT_TRUE(Reaches(first, JobState::kSucceeded));
  EXPECT_TRUE(Reaches(second, JobState::kSucceeded));
}

TEST_F(QueueTest, StopDoesNotWaitForAFailingStore) {
  auto saboteur = storage::Database::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(saboteur);
  std::atomic<int> runs = 0;
  queue_->RegisterRunner("work", [&](const JobRecord&, JobContext&) {
    ++runs;
    return Result<void>();
  });
  const std::string id = Submit("work");
  MANE_ASSERT_OK(
      saboteur->RunScript("CREATE TRIGGER sabotage BEFORE UPDATE ON jobs WHEN new.state = 3 "
                          "BEGIN SELECT raise(ABORT, 'broken'); END"));
  MANE_ASSERT_OK(queue_->Start());
  ASSERT_TRUE(Eventually([&] { return runs == 1; }));
  queue_->Stop();
  EXPECT_EQ(Get(id).job.state, JobState::kRunning);
  MANE_ASSERT_OK(saboteur->RunScript("DROP TRIGGER sabotage"));
  MANE_ASSERT_OK(queue_->Start());
  EXPECT_TRUE(Reaches(id, JobState::kSucceeded));
  EXPECT_EQ(runs, 2);
}

}  // namespace
}  // namespace mane::jobs
