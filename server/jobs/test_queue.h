#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "jobs/queue.h"
#include "storage/job_store.h"
#include "storage/test_folder.h"

namespace mane::jobs {

using storage::JobState;

/// Polls until `condition` holds; false if it does not within `limit`.
inline bool Eventually(const std::function<bool()>& condition,
                       std::chrono::milliseconds limit = std::chrono::seconds(20)) {
  const auto end = std::chrono::steady_clock::now() + limit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return true;
}

/// A runner that works until it is told to stop; fails if that never comes.
inline Result<void> RunUntilStopped(const storage::JobRecord&, JobContext& context) {
  if (Eventually([&] { return context.Cancelled(); })) return JobContext::StoppedError();
  return Error{ErrorCode::kInternal, "nobody stopped it", ""};
}

/// A queue on a store of its own.
class QueueTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto store = storage::JobStore::Open(folder_.DatabasePath());
    MANE_ASSERT_OK(store);
    store_ = std::move(*store);
    NewQueue();
  }

  // In place of the present one, which is stopped.
  void NewQueue(const QueueOptions& options = {}) {
    queue_.reset();
    queue_ = std::make_unique<Queue>(*store_, options);
  }

  std::string Submit(const std::string& kind, const std::string& spec = "",
                     const std::string& request_id = "") {
    const auto status = queue_->Submit({kind, spec, "about it", request_id});
    EXPECT_TRUE(status) << status.error().message;
    return status ? status->job.id : "";
  }

  JobStatus Get(const std::string& id) {
    const auto status = queue_->Get(id);
    EXPECT_TRUE(status) << id;
    return status ? *status : JobStatus();
  }

  bool Reaches(const std::string& id, JobState state) {
    return Eventually([&] { return Get(id).job.state == state; });
  }

  storage::TestFolder folder_;
  std::unique_ptr<storage::JobStore> store_;
  std::unique_ptr<Queue> queue_;
};

}  // namespace mane::jobs
