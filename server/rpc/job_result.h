#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/result.h"
#include "rpc/names.h"
#include "storage/job_store.h"

namespace mane::rpc {

/// The chunks of a finished job's result, one after the other. One thread at a time.
class JobResult {
 public:
  /// @param name  `jobs/{job}`, as a request's field `name` says it. @param kind  of the job.
  JobResult(storage::JobStore& store, std::string name, std::string kind)
      : store_(store), name_(std::move(name)), kind_(std::move(kind)) {}

  /// The next one; nothing at the end. kNotFound where there is no such job; kFailedPrecondition
  /// where it is of another kind or has not succeeded; both name `name`.
  Result<std::optional<std::string>> Next() {
    if (chunk_count_ < 0) {
      if (const auto ok = Find(); !ok) return ok.error();
    }
    if (next_ == chunk_count_) return std::optional<std::string>();
    auto bytes = store_.ReadResult(id_, next_++);
    if (!bytes) return bytes.error();
    return std::optional(*std::move(bytes));
  }

  /// For a chunk that does not parse.
  [[nodiscard]] static Error Damaged() {
    return {ErrorCode::kInternal, "the stored result is damaged", ""};
  }

 private:
  Result<void> Find() {
    const auto id = ParseName(name_, "jobs", "name");
    if (!id) return id.error();
    id_ = *id;
    const auto job = store_.Get(id_);
    if (!job) return job.error();
    if (job->kind != kind_ || job->state != storage::JobState::kSucceeded) {
      return Error{ErrorCode::kFailedPrecondition,
                   fmt::format("{} is no {} that succeeded; watch it until its state is SUCCEEDED",
                               name_, kind_),
                   "name"};
    }
    chunk_count_ = job->result_chunks;
    return {};
  }

  storage::JobStore& store_;
  const std::string name_;
  const std::string kind_;
  std::string id_;
  int64_t chunk_count_ = -1;  // Until the job is found.
  int64_t next_ = 0;
};

}  // namespace mane::rpc
