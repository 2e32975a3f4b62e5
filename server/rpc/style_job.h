#pragma once

#include <memory>
#include <mutex>
#include <string>

#include "base/result.h"
#include "groom/import.h"
#include "jobs/job_context.h"
#include "mane/v1/style.pb.h"
#include "rpc/groom_library.h"
#include "stored.pb.h"
#include "styling/stylist.h"

namespace mane::rpc {

inline constexpr const char* kStyleKind = "style";

/// How masters become guides: header.guides. kInvalidArgument names `header.guides.` and the field.
[[nodiscard]] Result<groom::ImportOptions> ToGuideOptions(const v1::ApplyStyleHeader& header);

/// RESOURCE_EXHAUSTED where the style makes more guides or work than a groom may.
[[nodiscard]] Result<void> AdmitStyle(const styling::Style& style,
                                      const groom::ImportOptions& guides,
                                      const groom::Limits& limits);

/// The id of the job that made the groom stored under `request_id`; empty where none did.
[[nodiscard]] std::string StyledBy(const std::string& request_id);

/// Runs style jobs: applies the style, writes what it made as the job's result (serialised
/// v1::HairstylePart, one a chunk), and makes the groom.
///
/// The stylist of the last head is kept, so that the next style for the same head makes anew only
/// what changed.
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
