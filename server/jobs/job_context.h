#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "base/result.h"
#include "storage/job_store.h"

namespace mane::jobs {

/// A running job's line to the queue: what it is to do, how far it is, whether it must stop.
///
/// Threads: any, at once, but for AppendResult, which one thread at a time calls.
class JobContext {
 public:
  /// `changed` is called after progress; `store` must outlive this.
  JobContext(storage::JobStore& store, storage::ClaimedJob job, std::function<void()> changed);

  /// The spec that was submitted.
  [[nodiscard]] const std::string& spec() const { return spec_; }

  /// True once the job must stop: it was cancelled, or the server stops and will start it over. A
  /// runner asks at least every 0.2 s and then returns StoppedError().
  [[nodiscard]] bool Cancelled() const { return stop_ != Stop::kNone; }
  [[nodiscard]] static Error StoppedError();

  /// Says that `fraction` of the work is done, 0 to 1. Only ever rises: less than before, or NaN,
  /// is ignored, more than 1 is 1. Seen at once by Queue::Get; on disk at most once a second. Cheap
  /// but for that write of some milliseconds.
  void Progress(double fraction);

  /// Adds the next chunk to the result; on disk when it returns, so worth some hundred kilobytes a
  /// call. StoppedError() once the job must stop; else the errors of JobStore::AppendResult.
  Result<void> AppendResult(std::string_view bytes);

 private:
  friend class Queue;

  // Why the job must stop. A cancel is stronger than a stop of the server.
  enum class Stop { kNone, kYield, kCancel };

  void Yield();
  void Cancel() { stop_ = Stop::kCancel; }
  [[nodiscard]] bool cancel_requested() const { return stop_ == Stop::kCancel; }
  [[nodiscard]] const storage::JobRecord& job() const { return job_; }
  [[nodiscard]] double progress() const { return progress_; }
  [[nodiscard]] double SecondsLeft() const;

  storage::JobStore& store_;
  const storage::JobRecord job_;  // As it was claimed.
  const std::string spec_;
  const std::function<void()> changed_;
  const double start_s_;  // Steady clock.
  std::atomic<Stop> stop_ = Stop::kNone;
  std::atomic<double> progress_ = 0;  // Written under mutex_.
  int64_t chunks_ = 0;                // Of AppendResult's thread.

  std::mutex mutex_;
  double stored_s_;  // When progress was last stored. Guarded by mutex_.
};

}  // namespace mane::jobs
