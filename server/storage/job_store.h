#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "storage/database.h"
#include "storage/page.h"

namespace mane::storage {

/// Where a job is in its life; the numbers are those of mane.v1.Job.State and of the database.
///
///     kQueued -> kRunning -> kSucceeded | kFailed | kCancelled
///     kRunning -> kQueued   when it was interrupted
///     kQueued -> kCancelled
enum class JobState {
  kQueued = 1,
  kRunning = 2,
  kSucceeded = 3,
  kFailed = 4,
  kCancelled = 5,
};

/// True for the states that a job never leaves.
[[nodiscard]] constexpr bool HasEnded(JobState state) { return state >= JobState::kSucceeded; }

/// A job to be inserted.
struct NewJob {
  std::string id;           ///< Last part of `jobs/{job}`; unique.
  std::string request_id;   ///< That of the request that made it; unique, or empty for none.
  std::string kind;         ///< Which runner it is for, `bake`.
  std::string description;  ///< For people.
  std::string spec;         ///< What to do, as bytes that mean nothing to the store.
};

/// What is known of a job, without its spec and its result. Times are [ns] since the Unix epoch, 0
/// before they have come.
struct JobRecord {
  std::string id;
  std::string request_id;
  std::string kind;
  std::string description;
  JobState state = JobState::kQueued;
  bool cancel_requested = false;  ///< While running: someone asked it to stop.
  double progress = 0;            ///< 0 to 1; 1 once succeeded.
  std::string error;              ///< Why it failed.
  int64_t create_time_ns = 0;
  int64_t start_time_ns = 0;
  int64_t end_time_ns = 0;
  int64_t result_chunks = 0;
  int64_t result_bytes = 0;  ///< Of all chunks together.

  bool operator==(const JobRecord&) const = default;
};

struct ClaimedJob {
  JobRecord job;
  std::string spec;
};

/// The jobs on disk with their results. A result is a row of chunks, numbered from 0, so that a
/// long one never has to be in memory whole; only a job that succeeded keeps one.
///
/// What a call has acknowledged survives the death of the process and of the machine.
///
/// Threads: any; calls run one after the other on the store's own connection, and a writing call
///          returns when the disk has the data (milliseconds).
/// Errors:  besides those named, every call can fail as the disk does: kUnavailable, or
///          kResourceExhausted when it is full (see DatabaseError). Calls that take an `id` give
///          NOT_FOUND if there is no such job.
class JobStore {
 public:
  /// Opens or creates the database file; see Database::Open for the errors.
  static Result<std::unique_ptr<JobStore>> Open(const std::filesystem::path& path);

  /// Queues a job. When a job of the same non-empty `request_id` is there, inserts nothing and
  /// returns that one. RESOURCE_EXHAUSTED when `max_queued` jobs wait already; ALREADY_EXISTS if
  /// `id` is taken.
  Result<JobRecord> Insert(const NewJob& job, int64_t max_queued);

  Result<JobRecord> Get(std::string_view id);

  /// Jobs in the reverse order of their insertion, at most `page_size` (1 to kMaxPageSize) of them,
  /// after the page that returned `page_token`; the newest ones for an empty token. A job that is
  /// there during the whole walk is listed once, whatever is inserted or deleted meanwhile.
  /// INVALID_ARGUMENT for a token that no page returned.
  Result<Page<JobRecord>> List(int page_size, std::string_view page_token);

  /// Takes the oldest queued job: it is kRunning from now on. None when nothing is queued.
  Result<std::optional<ClaimedJob>> ClaimNext();

  /// Notes how far a running job is, 0 to 1; of no effect on another one.
  Result<void> SetProgress(std::string_view id, double progress);

  /// Adds chunk number `chunk` to the result of a running job. FAILED_PRECONDITION if the job does
  /// not run or `chunk` is not the number of chunks it has.
  Result<void> AppendResult(std::string_view id, int64_t chunk, std::string_view bytes);
  /// NOT_FOUND too for a chunk that is not there. Chunks of a running job can be read.
  Result<std::string> ReadResult(std::string_view id, int64_t chunk);

  /// Ends a running job as `state`, one of the ended ones; `error` says why it failed. Drops what
  /// result there is unless it succeeded. FAILED_PRECONDITION if the job does not run.
  Result<void> Finish(std::string_view id, JobState state, std::string_view error);

  /// Cancels a queued job at once; notes the request on a running one, whose runner must obey;
  /// leaves an ended one as it is. Returns what came of it.
  Result<JobRecord> RequestCancel(std::string_view id);

  /// Puts a running job back in its place in the queue, without result and progress, or cancels it
  /// if that was requested. FAILED_PRECONDITION if the job does not run.
  Result<void> Requeue(std::string_view id);
  /// Does so with every running job; for the start, when none can really be running.
  Result<void> RequeueInterrupted();

  /// Deletes an ended job and its result. FAILED_PRECONDITION while it is queued or running.
  Result<void> Delete(std::string_view id);
  /// Deletes the ended jobs but for the `keep` ones that ended last.
  Result<void> DeleteOldest(int64_t keep);

 private:
  explicit JobStore(Database database) : database_(std::move(database)) {}

  std::mutex mutex_;
  Database database_;  // Guarded by mutex_.
};

}  // namespace mane::storage
