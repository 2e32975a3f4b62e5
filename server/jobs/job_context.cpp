#include "jobs/job_context.h"

#include <algorithm>
#include <utility>

#include "base/clock.h"

namespace mane::jobs {

namespace {

constexpr double kStoreIntervalS = 1.0;

}  // namespace

JobContext::JobContext(storage::JobStore& store, storage::ClaimedJob job,
                       std::function<void()> changed)
    : store_(store),
      job_(std::move(job.job)),
      spec_(std::move(job.spec)),
      changed_(std::move(changed)),
      start_s_(base::SteadySeconds()),
      stored_s_(start_s_) {}

Error JobContext::StoppedError() { return {ErrorCode::kCancelled, "the job was stopped", ""}; }

void JobContext::Progress(double fraction) {
  bool store_it = false;
  {
    std::lock_guard lock(mutex_);
    if (!(fraction > progress_)) return;
    progress_ = std::min(fraction, 1.0);
    const double now_s = base::SteadySeconds();
    store_it = now_s - stored_s_ >= kStoreIntervalS;
    if (store_it) stored_s_ = now_s;
  }
  changed_();
  if (store_it) {
    // The copy on disk only informs: a disk that fails shows when the result is written.
    [[maybe_unused]] const auto stored = store_.SetProgress(job_.id, progress_);
  }
}

Result<void> JobContext::AppendResult(std::string_view bytes) {
  if (Cancelled()) return StoppedError();
  auto appended = store_.AppendResult(job_.id, chunks_, bytes);
  if (appended) ++chunks_;
  return appended;
}

void JobContext::Yield() {
  Stop none = Stop::kNone;
  stop_.compare_exchange_strong(none, Stop::kYield);
}

double JobContext::SecondsLeft() const {
  const double done = progress_;
  if (done <= 0) return 0;
  return (base::SteadySeconds() - start_s_) * (1 - done) / done;
}

}  // namespace mane::jobs
