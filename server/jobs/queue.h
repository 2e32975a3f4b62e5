#pragma once

#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/result.h"
#include "jobs/job_context.h"
#include "jobs/job_status.h"
#include "jobs/watchers.h"
#include "storage/job_store.h"

namespace mane::jobs {

struct QueueOptions {
  /// Jobs that run at once, each on a thread of its own; 1 to 256.
  int workers = 1;
  /// Jobs that may wait; 1 to 1e6. More are refused with RESOURCE_EXHAUSTED.
  int max_queued = 1000;
  /// Ended jobs that are kept with their results; 1 to 1e6. When one more ends, the one that ended
  /// first is deleted. Bounds the disk only together with the size of a result.
  int max_ended = 1000;

  /// INVALID_ARGUMENT names the field out of its range.
  [[nodiscard]] Result<void> Validate() const;
};

/// What a caller submits.
struct JobRequest {
  std::string kind;         ///< One of the registered kinds.
  std::string spec;         ///< What its runner understands; checked by the caller.
  std::string description;  ///< For people: `grooms/demo, 524 poses`.
  std::string request_id;   ///< Makes a retry safe; empty for none.
};

/// Runs long work, one job after the other, oldest first, and tells how it goes.
///
/// A submitted job is on disk. It runs at least once to its end: when the process dies or Stop
/// comes, it starts over at the next Start, without the partial result. A runner that fails, throws
/// or fails a MANE_CHECK fails its job only. A worker that cannot write a job's end to disk tries
/// again until it can or the queue stops.
///
/// Threads: everything but RegisterRunner, Start and Stop (their owner's, one at a time) may be
///          called from any thread, before Start and after Stop too. Calls that write return when
///          the disk has the data (milliseconds). Runners run on the workers, callbacks on the one
///          thread of Watchers; neither under a lock of the queue.
/// Errors:  besides those named, NOT_FOUND for an unknown id, and those of the store.
class Queue {
 public:
  /// Does a job's work. Returns JobContext::StoppedError() when it was told to stop; a result that
  /// is complete all the same counts. Another error fails the job with its message.
  using Runner = std::function<Result<void>(const storage::JobRecord&, JobContext&)>;

  /// `store` must outlive the queue and have no other one. `options` must be valid.
  Queue(storage::JobStore& store, const QueueOptions& options);
  /// Stops. Must not be called from a callback.
  ~Queue();

  /// Says who does jobs of `kind`; once per kind, before any other call.
  void RegisterRunner(std::string kind, Runner runner);

  /// Puts interrupted jobs back in the queue and starts the workers. A queued job of a kind that no
  /// runner was registered for will fail.
  Result<void> Start();
  /// Tells running jobs to yield, waits until they have, and leaves them queued. Harmless when not
  /// started; Start may follow.
  void Stop();

  /// Queues a job, or returns the one that a request of the same non-empty `request_id` made.
  /// INVALID_ARGUMENT for an unknown kind; RESOURCE_EXHAUSTED when too many wait.
  Result<JobStatus> Submit(const JobRequest& request);

  Result<JobStatus> Get(const std::string& id);
  /// Newest first; see JobStore::List.
  Result<storage::Page<JobStatus>> List(int page_size, std::string_view page_token);

  /// Cancels a queued job at once and tells a running one to stop, which takes as long as its
  /// runner does to notice (JobContext::Cancelled). An ended one stays as it is.
  Result<JobStatus> Cancel(const std::string& id);

  /// Deletes an ended job and its result. FAILED_PRECONDITION while it is queued or running.
  Result<void> Delete(const std::string& id);

  /// Follows a job; see Watchers.
  [[nodiscard]] Subscription Watch(std::string id, Watchers::Callback callback);

 private:
  using LiveJobs = std::map<std::string, std::shared_ptr<JobContext>, std::less<>>;

  void Work();
  void Run(storage::ClaimedJob claimed);
  Result<void> CallRunner(JobContext& context) const;
  void Settle(const JobContext& context, const Result<void>& outcome);
  bool PauseAfter(const Error& error, std::string_view what);
  LiveJobs Live();
  static JobStatus Merge(storage::JobRecord job, const LiveJobs& live);

  storage::JobStore& store_;
  const QueueOptions options_;
  std::map<std::string, Runner, std::less<>> runners_;  // Constant while started.

  std::mutex mutex_;  // Guards what follows; never held while the store works.
  std::condition_variable wake_;
  LiveJobs live_;             // Of the workers, by job id.
  uint64_t submissions_ = 0;  // Tells an idle worker that there is something new.
  bool stopping_ = false;

  Watchers watchers_;  // Its thread calls Get.
  std::vector<std::jthread> workers_;
};

}  // namespace mane::jobs
