#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "base/result.h"
#include "groom/import.h"
#include "jobs/job_context.h"
#include "rpc/groom_library.h"
#include "rpc/styled_hair.h"
#include "stored.pb.h"
#include "styling/stylist.h"

namespace mane::rpc {

inline constexpr const char* kStyleKind = "style";

/// The id of the job that made the groom stored under `request_id`; empty where none did.
[[nodiscard]] std::string StyledBy(const std::string& request_id);

/// Runs style jobs: applies the style, writes what it made as the job's result (serialised
/// v1::HairstylePart, one a chunk), and makes the groom.
///
/// The stylist of the last head is kept, so that the next style by wisps for the same head makes
/// anew only what changed.
///
/// Threads: any.
class StyleJobs {
 public:
  StyleJobs(GroomLibrary& library, exec::WorkerPool& pool) : library_(library), pool_(pool) {}

  /// @param job  id of the job, which makes its groom once even when it is run again.
  Result<void> Run(const std::string& job, jobs::JobContext& context);

 private:
  struct LastHead {
    std::string head;  // Its stored bytes.
    std::unique_ptr<styling::Stylist> stylist;
  };

  // The part of a job that is a wisp style's; writes what it made.
  Result<StyledHair> StyleByWisps(const StoredStyle& spec, const groom::Parts& parts,
                                  const groom::ImportOptions& guides, jobs::JobContext& context);
  // The stylist of the head that `spec` says, if it was the last one; else none. Another job of the
  // same head makes its own meanwhile.
  LastHead Take(const StoredStyle& spec);
  // `points` its members have; a stylist of many is not kept.
  void Keep(LastHead head, size_t points);

  GroomLibrary& library_;
  exec::WorkerPool& pool_;
  std::mutex mutex_;
  LastHead last_;  // Guarded by mutex_.
};

}  // namespace mane::rpc
