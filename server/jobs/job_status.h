#pragma once

#include "storage/job_store.h"

namespace mane::jobs {

/// A job as of now: what is stored, with the live progress of a running one.
struct JobStatus {
  storage::JobRecord job;
  double seconds_left = 0;  ///< Estimate while running, from the mean rate so far; 0 if unknown.
};

}  // namespace mane::jobs
