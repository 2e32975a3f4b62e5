#include "jobs/queue.h"

#include <spdlog/spdlog.h>

#include <chrono>
#include <exception>
#include <random>
#include <utility>

namespace mane::jobs {

using storage::JobRecord;
using storage::JobState;

namespace {

constexpr std::chrono::milliseconds kRetryInterval{1000};

Result<void> CheckRange(const char* field, int value, int low, int high) {
  if (value >= low && value <= high) return {};
  return InvalidArgument(field,
                         fmt::format("{} is {}; it must be in [{}, {}]", field, value, low, high));
}

// 64 random bits: no job takes an earlier one's name, not even after the data was wiped.
std::string NewJobId() {
  std::random_device entropy;
  return fmt::format("{:08x}{:08x}", entropy(), entropy());
}

std::string Describe(const Error& error) {
  return error.field.empty() ? error.message : fmt::format("{}: {}", error.field, error.message);
}

const char* NameOf(JobState state) {
  switch (state) {
    case JobState::kQueued:
      return "queued";
    case JobState::kRunning:
      return "running";
    case JobState::kSucceeded:
      return "succeeded";
    case JobState::kFailed:
      return "failed";
    case JobState::kCancelled:
      return "cancelled";
  }
  return "unknown";
}

Error InternalFault(std::string_view what) {
  return {ErrorCode::kInternal, fmt::format("internal fault: {}", what), ""};
}

}  // namespace

Result<void> QueueOptions::Validate() const {
  if (auto checked = CheckRange("workers", workers, 1, 256); !checked) return checked;
  if (auto checked = CheckRange("max_queued", max_queued, 1, 1'000'000); !checked) return checked;
  return CheckRange("max_ended", max_ended, 1, 1'000'000);
}

Queue::Queue(storage::JobStore& store, const QueueOptions& options)
    : store_(store),
      options_(options),
      watchers_([this](const std::string& id) { return Get(id); }) {
  MANE_CHECK(options.Validate().has_value());
}

Queue::~Queue() { Stop(); }

void Queue::RegisterRunner(std::string kind, Runner runner) {
  MANE_CHECK(workers_.empty());
  const bool is_new = runners_.emplace(std::move(kind), std::move(runner)).second;
  MANE_CHECK(is_new);
}

Result<void> Queue::Start() {
  MANE_CHECK(workers_.empty());
  if (auto requeued = store_.RequeueInterrupted(); !requeued) return requeued;
  if (auto deleted = store_.DeleteOldest(options_.max_ended); !deleted) return deleted;
  {
    std::lock_guard lock(mutex_);
    stopping_ = false;
  }
  for (int i = 0; i < options_.workers; ++i) workers_.emplace_back([this] { Work(); });
  return {};
}

void Queue::Stop() {
  {
    std::lock_guard lock(mutex_);
    stopping_ = true;
    for (auto& [id, context] : live_) context->Yield();
    wake_.notify_all();
  }
  workers_.clear();  // Joins them.
}

Result<JobStatus> Queue::Submit(const JobRequest& request) {
  if (!runners_.contains(request.kind)) {
    return InvalidArgument(
        "kind", fmt::format("kind is `{}`, which this server does not run", request.kind));
  }
  auto job = store_.Insert(
      {NewJobId(), request.request_id, request.kind, request.description, request.spec},
      options_.max_queued);
  if (!job) return job.error();
  {
    std::lock_guard lock(mutex_);
    ++submissions_;
    wake_.notify_all();
  }
  return JobStatus{std::move(*job)};
}

// A running job is found among the live ones first: it leaves them only when its end is stored, so
// that what is read from the store afterwards is newer.
Result<JobStatus> Queue::Get(const std::string& id) {
  const LiveJobs live = Live();
  auto job = store_.Get(id);
  if (!job) return job.error();
  return Merge(std::move(*job), live);
}

Result<storage::Page<JobStatus>> Queue::List(int page_size, std::string_view page_token) {
  const LiveJobs live = Live();
  auto stored = store_.List(page_size, page_token);
  if (!stored) return stored.error();
  storage::Page<JobStatus> page;
  page.next_page_token = std::move(stored->next_page_token);
  for (JobRecord& job : stored->records) page.records.push_back(Merge(std::move(job), live));
  return page;
}

Result<JobStatus> Queue::Cancel(const std::string& id) {
  auto job = store_.RequestCancel(id);
  if (!job) return job.error();
  // After the store: Run looks in the opposite order, so that one of the two sees the other.
  const LiveJobs live = Live();
  if (job->state == JobState::kRunning) {
    if (const auto found = live.find(id); found != live.end()) found->second->Cancel();
  }
  watchers_.Changed(id);
  return Merge(std::move(*job), live);
}

Result<void> Queue::Delete(const std::string& id) {
  auto deleted = store_.Delete(id);
  if (deleted) watchers_.Changed(id);
  return deleted;
}

Subscription Queue::Watch(std::string id, Watchers::Callback callback) {
  return watchers_.Watch(std::move(id), std::move(callback));
}

JobStatus Queue::Merge(JobRecord job, const LiveJobs& live) {
  JobStatus status{std::move(job)};
  const auto found = live.find(status.job.id);
  if (status.job.state == JobState::kRunning && found != live.end()) {
    status.job.progress = found->second->progress();
    status.seconds_left = found->second->SecondsLeft();
  }
  return status;
}

Queue::LiveJobs Queue::Live() {
  std::lock_guard lock(mutex_);
  return live_;
}

void Queue::Work() {
  while (true) {
    uint64_t seen = 0;
    {
      std::lock_guard lock(mutex_);
      if (stopping_) return;
      seen = submissions_;
    }
    auto claimed = store_.ClaimNext();
    if (!claimed) {
      if (!PauseAfter(claimed.error(), "claim")) return;
    } else if (*claimed) {
      Run(std::move(**claimed));
    } else {
      std::unique_lock lock(mutex_);
      wake_.wait(lock, [&] { return stopping_ || submissions_ != seen; });
    }
  }
}

void Queue::Run(storage::ClaimedJob claimed) {
  const std::string id = claimed.job.id;
  const auto context = std::make_shared<JobContext>(store_, std::move(claimed),
                                                    [this, id] { watchers_.Changed(id); });
  {
    std::lock_guard lock(mutex_);
    live_.emplace(id, context);
    if (stopping_) context->Yield();
  }
  // A cancel may have come between the claim and the line above.
  if (const auto job = store_.Get(id); job && job->cancel_requested) context->Cancel();
  watchers_.Changed(id);

  Settle(*context, CallRunner(*context));
  {
    std::lock_guard lock(mutex_);
    live_.erase(id);
  }
  watchers_.Changed(id);
  if (auto deleted = store_.DeleteOldest(options_.max_ended); !deleted) {
    spdlog::error("job_retention_failed error=\"{}\"", deleted.error().message);
  }
}

Result<void> Queue::CallRunner(JobContext& context) const {
  const JobRecord& job = context.job();
  const auto runner = runners_.find(job.kind);
  if (runner == runners_.end()) {
    return Error{ErrorCode::kFailedPrecondition,
                 fmt::format("this server has no runner for jobs of kind `{}`", job.kind), ""};
  }
  try {
    return runner->second(job, context);
  } catch (const std::exception& e) {
    return InternalFault(e.what());
  } catch (...) {
    return InternalFault("an exception that is no std::exception");
  }
}

// Stores what came of a job.
void Queue::Settle(const JobContext& context, const Result<void>& outcome) {
  const JobRecord& job = context.job();
  const bool stopped =
      !outcome && outcome.error().code == ErrorCode::kCancelled && context.Cancelled();
  JobState state = JobState::kSucceeded;
  std::string error;
  if (stopped) {
    state = context.cancel_requested() ? JobState::kCancelled : JobState::kQueued;
  } else if (!outcome) {
    state = JobState::kFailed;
    error = Describe(outcome.error());
  }
  // What a watcher saw last stays: progress on disk lags behind. (A failure here costs only that.)
  if (state != JobState::kQueued) (void)store_.SetProgress(job.id, context.progress());
  while (true) {
    const auto stored =
        state == JobState::kQueued ? store_.Requeue(job.id) : store_.Finish(job.id, state, error);
    if (stored) break;
    if (!PauseAfter(stored.error(), "settle")) return;
  }
  if (state == JobState::kFailed) {
    spdlog::warn("job_failed job={} kind={} error=\"{}\"", job.id, job.kind, error);
  } else {
    spdlog::info("job_settled job={} kind={} state={}", job.id, job.kind, NameOf(state));
  }
}

// Waits a second before another try. False when there shall be none: the queue stops, or the store
// knows the job otherwise.
bool Queue::PauseAfter(const Error& error, std::string_view what) {
  spdlog::error("job_store_failed during={} error=\"{}\"", what, error.message);
  if (error.code == ErrorCode::kNotFound || error.code == ErrorCode::kFailedPrecondition) {
    return false;
  }
  std::unique_lock lock(mutex_);
  return !wake_.wait_for(lock, kRetryInterval, [this] { return stopping_; });
}

}  // namespace mane::jobs
