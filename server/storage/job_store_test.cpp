// Properties of the job store:
//   life        a job moves only along the arrows of JobState; each move is on disk
//   order       claimed oldest first, each by one claimer; listed newest first, each once
//   requests    a request id makes one job
//   results     chunks come back in order; only a job that succeeded keeps them

#include "storage/job_store.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "storage/test_folder.h"

namespace mane::storage {
namespace {

class JobStoreTest : public ::testing::Test {
 protected:
  void SetUp() override { Reopen(); }

  void Reopen() {
    store_.reset();
    auto store = JobStore::Open(folder_.DatabasePath());
    MANE_ASSERT_OK(store);
    store_ = std::move(*store);
  }

  void Insert(const std::string& id, const std::string& request_id = "") {
    MANE_ASSERT_OK(store_->Insert({id, request_id, "bake", "about " + id, "spec of " + id}, 100));
  }

  // The id of the job that was claimed; empty for none.
  std::string Claim() {
    const auto claimed = store_->ClaimNext();
    EXPECT_TRUE(claimed);
    return *claimed ? (*claimed)->job.id : "";
  }

  void InsertRunning(const std::string& id) {
    Insert(id);
    ASSERT_EQ(Claim(), id);
  }

  JobRecord Get(const std::string& id) {
    const auto job = store_->Get(id);
    EXPECT_TRUE(job) << id;
    return job ? *job : JobRecord();
  }

  static void ExpectCode(const Result<void>& result, ErrorCode code) {
    ASSERT_FALSE(result);
    EXPECT_EQ(result.error().code, code) << result.error().message;
  }

  TestFolder folder_;
  std::unique_ptr<JobStore> store_;
};

TEST_F(JobStoreTest, InsertedJobIsQueuedAlsoAfterReopening) {
  const auto inserted =
      store_->Insert({"j", "request", "bake", "grooms/demo", std::string("s\0p", 3)}, 100);
  MANE_ASSERT_OK(inserted);
  EXPECT_EQ(inserted->id, "j");
  EXPECT_EQ(inserted->request_id, "request");
  EXPECT_EQ(inserted->kind, "bake");
  EXPECT_EQ(inserted->description, "grooms/demo");
  EXPECT_EQ(inserted->state, JobState::kQueued);
  EXPECT_GT(inserted->create_time_ns, 0);
  EXPECT_EQ(inserted->start_time_ns, 0);
  EXPECT_EQ(inserted->end_time_ns, 0);
  Reopen();
  EXPECT_EQ(Get("j"), *inserted);
  const auto claimed = store_->ClaimNext();
  MANE_ASSERT_OK(claimed);
  ASSERT_TRUE(claimed->has_value());
  EXPECT_EQ((*claimed)->spec, std::string("s\0p", 3));
}

TEST_F(JobStoreTest, ClaimedOldestFirst) {
  for (const char* id : {"c", "a", "b"}) Insert(id);
  EXPECT_EQ(Claim(), "c");
  EXPECT_EQ(Claim(), "a");
  EXPECT_EQ(Claim(), "b");
  EXPECT_EQ(Claim(), "");
  EXPECT_EQ(Get("a").state, JobState::kRunning);
  EXPECT_GE(Get("a").start_time_ns, Get("a").create_time_ns);
}

// Through two stores on one file, so that the file's lock is tried as well as the mutex.
TEST_F(JobStoreTest, EachJobIsClaimedOnce) {
  constexpr int kJobs = 30;
  for (int i = 0; i < kJobs; ++i) Insert(fmt::format("{:02}", i));
  auto other = JobStore::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(other);
  std::vector<std::string> claimed[4];
  std::vector<std::thread> threads;
  for (int t = 0; t < 4; ++t) {
    threads.emplace_back([&, t] {
      JobStore& store = t % 2 == 0 ? *store_ : **other;
      while (true) {
        const auto job = store.ClaimNext();
        if (!job || !*job) return;
        claimed[t].push_back((*job)->job.id);
      }
    });
  }
  for (auto& thread : threads) thread.join();
  std::vector<std::string> all;
  for (const auto& ids : claimed) {
    EXPECT_TRUE(std::is_sorted(ids.begin(), ids.end()));
    all.insert(all.end(), ids.begin(), ids.end());
  }
  std::sort(all.begin(), all.end());
  ASSERT_EQ(all.size(), size_t{kJobs});
  EXPECT_EQ(std::adjacent_find(all.begin(), all.end()), all.end());
}

TEST_F(JobStoreTest, RepeatedRequestReturnsTheFirstJob) {
  Insert("first", "request");
  const auto again = store_->Insert({"second", "request", "bake", "", ""}, 100);
  MANE_ASSERT_OK(again);
  EXPECT_EQ(*again, Get("first"));
  EXPECT_EQ(store_->Get("second").error().code, ErrorCode::kNotFound);
}

TEST_F(JobStoreTest, TakenIdAndFullQueueAreRefused) {
  Insert("a", "request");
  EXPECT_EQ(store_->Insert({"a", "", "bake", "", ""}, 100).error().code, ErrorCode::kAlreadyExists);
  const auto full = store_->Insert({"b", "", "bake", "", ""}, 1);
  ASSERT_FALSE(full);
  EXPECT_EQ(full.error().code, ErrorCode::kResourceExhausted);
  EXPECT_NE(full.error().message.find("at most 1"), std::string::npos) << full.error().message;
  // A retry takes no room, and a running job does not wait.
  MANE_EXPECT_OK(store_->Insert({"b", "request", "bake", "", ""}, 1));
  EXPECT_EQ(Claim(), "a");
  MANE_EXPECT_OK(store_->Insert({"b", "", "bake", "", ""}, 1));
}

TEST_F(JobStoreTest, PagesHoldEveryJobOnceNewestFirst) {
  for (const char* id : {"e", "a", "d", "b", "c"}) Insert(id);
  for (int page_size = 1; page_size <= 6; ++page_size) {
    SCOPED_TRACE(page_size);
    std::string ids, token;
    do {
      const auto page = store_->List(page_size, token);
      MANE_ASSERT_OK(page);
      for (const auto& job : page->records) ids += job.id;
      token = page->next_page_token;
    } while (!token.empty());
    EXPECT_EQ(ids, "cbdae");
  }
}

TEST_F(JobStoreTest, PagingSurvivesChanges) {
  for (const char* id : {"a", "b", "c", "d"}) Insert(id);
  auto page = store_->List(2, "");
  MANE_ASSERT_OK(page);
  MANE_ASSERT_OK(store_->RequestCancel("c"));
  MANE_ASSERT_OK(store_->Delete("c"));  // The page's last one, which the token stands for.
  Insert("e");
  page = store_->List(2, page->next_page_token);
  MANE_ASSERT_OK(page);
  ASSERT_EQ(page->records.size(), 2u);
  EXPECT_EQ(page->records[0].id, "b");
  EXPECT_EQ(page->records[1].id, "a");
}

TEST_F(JobStoreTest, WrongPagingIsRefused) {
  for (const char* token : {"x", "1x", "-1", "0", " 1", "99999999999999999999"}) {
    const auto page = store_->List(10, token);
    ASSERT_FALSE(page) << token;
    EXPECT_EQ(page.error().field, "page_token");
    EXPECT_NE(page.error().message.find(token), std::string::npos);
  }
  // Long or unprintable ones are not repeated whole.
  const auto page = store_->List(10, "\xc3\xa4" + std::string(100'000, 'x'));
  ASSERT_FALSE(page);
  EXPECT_EQ(page.error().message,
            "page_token is `\xC3\xA4" + std::string(124, 'x') + "`, which no answer gave");
  EXPECT_EQ(store_->List(0, "").error().field, "page_size");
}

TEST_F(JobStoreTest, ResultComesBackInChunks) {
  InsertRunning("j");
  const std::vector<std::string> chunks = {"first", "", std::string(500'000, '\x80')};
  for (size_t i = 0; i < chunks.size(); ++i) {
    MANE_ASSERT_OK(store_->AppendResult("j", static_cast<int64_t>(i), chunks[i]));
  }
  ExpectCode(store_->AppendResult("j", 2, "again"), ErrorCode::kFailedPrecondition);
  ExpectCode(store_->AppendResult("j", 4, "too far"), ErrorCode::kFailedPrecondition);
  MANE_ASSERT_OK(store_->Finish("j", JobState::kSucceeded, ""));
  ExpectCode(store_->AppendResult("j", 3, "too late"), ErrorCode::kFailedPrecondition);
  Reopen();
  EXPECT_EQ(Get("j").result_chunks, 3);
  EXPECT_EQ(Get("j").result_bytes, 500'005);
  for (size_t i = 0; i < chunks.size(); ++i) {
    const auto chunk = store_->ReadResult("j", static_cast<int64_t>(i));
    MANE_ASSERT_OK(chunk);
    EXPECT_EQ(*chunk, chunks[i]);
  }
  for (const int64_t chunk : {-1, 3}) {
    EXPECT_EQ(store_->ReadResult("j", chunk).error().code, ErrorCode::kNotFound);
  }
}

TEST_F(JobStoreTest, OnlySuccessKeepsTheResult) {
  for (const auto state : {JobState::kSucceeded, JobState::kFailed, JobState::kCancelled}) {
    const std::string id = std::to_string(static_cast<int>(state));
    InsertRunning(id);
    MANE_ASSERT_OK(store_->AppendResult(id, 0, "chunk"));
    MANE_ASSERT_OK(store_->SetProgress(id, 0.5));
    MANE_ASSERT_OK(store_->Finish(id, state, "why"));
    const JobRecord job = Get(id);
    const bool succeeded = state == JobState::kSucceeded;
    EXPECT_EQ(job.state, state);
    EXPECT_EQ(job.error, "why");
    EXPECT_GE(job.end_time_ns, job.start_time_ns);
    EXPECT_EQ(job.progress, succeeded ? 1 : 0.5);
    EXPECT_EQ(job.result_chunks, succeeded ? 1 : 0);
    EXPECT_EQ(job.result_bytes, succeeded ? 5 : 0);
    EXPECT_EQ(store_->ReadResult(id, 0).has_value(), succeeded);
  }
}

TEST_F(JobStoreTest, OnlyARunningJobCanEndOrMoveOn) {
  Insert("queued");
  ExpectCode(store_->Finish("queued", JobState::kFailed, ""), ErrorCode::kFailedPrecondition);
  ExpectCode(store_->Requeue("queued"), ErrorCode::kFailedPrecondition);
  ExpectCode(store_->AppendResult("queued", 0, ""), ErrorCode::kFailedPrecondition);
  MANE_ASSERT_OK(store_->SetProgress("queued", 0.5));
  EXPECT_EQ(Get("queued").progress, 0);
  ASSERT_EQ(Claim(), "queued");
  MANE_ASSERT_OK(store_->Finish("queued", JobState::kSucceeded, ""));
  const JobRecord ended = Get("queued");
  ExpectCode(store_->Finish("queued", JobState::kFailed, ""), ErrorCode::kFailedPrecondition);
  ExpectCode(store_->Requeue("queued"), ErrorCode::kFailedPrecondition);
  MANE_ASSERT_OK(store_->RequestCancel("queued"));
  EXPECT_EQ(Get("queued"), ended);
}

TEST_F(JobStoreTest, CancelEndsAQueuedJobAndAsksARunningOne) {
  InsertRunning("running");
  Insert("queued");
  const auto queued = store_->RequestCancel("queued");
  MANE_ASSERT_OK(queued);
  EXPECT_EQ(queued->state, JobState::kCancelled);
  EXPECT_GT(queued->end_time_ns, 0);
  EXPECT_EQ(Claim(), "");
  const auto running = store_->RequestCancel("running");
  MANE_ASSERT_OK(running);
  EXPECT_EQ(running->state, JobState::kRunning);
  EXPECT_TRUE(running->cancel_requested);
}

TEST_F(JobStoreTest, InterruptedJobsStartOverInTheirPlace) {
  InsertRunning("first");
  InsertRunning("cancelled");
  Insert("waiting");
  MANE_ASSERT_OK(store_->AppendResult("first", 0, "partial"));
  MANE_ASSERT_OK(store_->SetProgress("first", 0.5));
  MANE_ASSERT_OK(store_->RequestCancel("cancelled"));
  Reopen();
  MANE_ASSERT_OK(store_->RequeueInterrupted());

  const JobRecord job = Get("first");
  EXPECT_EQ(job.state, JobState::kQueued);
  EXPECT_EQ(job.progress, 0);
  EXPECT_EQ(job.start_time_ns, 0);
  EXPECT_EQ(job.result_chunks, 0);
  EXPECT_EQ(job.result_bytes, 0);
  EXPECT_FALSE(store_->ReadResult("first", 0));
  EXPECT_EQ(Get("cancelled").state, JobState::kCancelled);
  EXPECT_EQ(Claim(), "first");
  EXPECT_EQ(Claim(), "waiting");
  EXPECT_EQ(Claim(), "");
  MANE_ASSERT_OK(store_->AppendResult("first", 0, "whole"));
  EXPECT_EQ(*store_->ReadResult("first", 0), "whole");
}

TEST_F(JobStoreTest, OnlyAnEndedJobCanBeDeleted) {
  InsertRunning("running");
  Insert("queued");
  ExpectCode(store_->Delete("running"), ErrorCode::kFailedPrecondition);
  ExpectCode(store_->Delete("queued"), ErrorCode::kFailedPrecondition);
  ExpectCode(store_->Delete("unknown"), ErrorCode::kNotFound);
  MANE_ASSERT_OK(store_->AppendResult("running", 0, "chunk"));
  MANE_ASSERT_OK(store_->Finish("running", JobState::kSucceeded, ""));
  MANE_ASSERT_OK(store_->Delete("running"));
  EXPECT_EQ(store_->Get("running").error().code, ErrorCode::kNotFound);

  auto database = Database::Open(folder_.DatabasePath());
  MANE_ASSERT_OK(database);
  auto leftovers = database->Prepare(
      "SELECT (SELECT count(*) FROM job_results), "
      "(SELECT count(*) FROM job_specs), count(*) FROM jobs");
  MANE_ASSERT_OK(leftovers);
  MANE_ASSERT_OK(leftovers->Step());
  EXPECT_EQ(leftovers->Integer(0), 0);
  EXPECT_EQ(leftovers->Integer(1), 1);
  EXPECT_EQ(leftovers->Integer(2), 1);
}

TEST_F(JobStoreTest, TheJobsThatEndedLastAreKept) {
  for (const char* id : {"a", "b", "c"}) InsertRunning(id);
  Insert("queued");
  for (const char* id : {"c", "a", "b"}) {
    MANE_ASSERT_OK(store_->Finish(id, JobState::kSucceeded, ""));
  }
  MANE_ASSERT_OK(store_->DeleteOldest(2));
  EXPECT_FALSE(store_->Get("c"));
  EXPECT_TRUE(store_->Get("a"));
  EXPECT_TRUE(store_->Get("b"));
  EXPECT_EQ(Get("queued").state, JobState::kQueued);
}

TEST_F(JobStoreTest, UnknownJobIsNamed) {
  const auto job = store_->Get("nobody");
  ASSERT_FALSE(job);
  EXPECT_EQ(job.error().code, ErrorCode::kNotFound);
  EXPECT_NE(job.error().message.find("jobs/nobody"), std::string::npos);
  EXPECT_EQ(store_->RequestCancel("nobody").error().code, ErrorCode::kNotFound);
  EXPECT_EQ(store_->ReadResult("nobody", 0).error().code, ErrorCode::kNotFound);
  ExpectCode(store_->AppendResult("nobody", 0, ""), ErrorCode::kNotFound);
  ExpectCode(store_->Finish("nobody", JobState::kFailed, ""), ErrorCode::kNotFound);
}

}  // namespace
}  // namespace mane::storage
