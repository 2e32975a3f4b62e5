#pragma once

#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "groom/import.h"
#include "groom/limits.h"
#include "jobs/job_context.h"
#include "rpc/styled_hair.h"

namespace mane::rpc {

/// The part of a style job that is a beam style's: bends all hair, and writes what it made as the
/// job's result. kCancelled, or anything, soon after the job must stop; RESOURCE_EXHAUSTED where
/// its guides would take too long.
///
/// @param scalp   valid and not empty. @param guides  how hairs will become guides, valid.
[[nodiscard]] Result<StyledHair> StyleByBeams(const v1::BeamStyle& message,
                                              const groom::Scalp& scalp,
                                              const groom::ImportOptions& guides,
                                              const groom::Limits& limits, exec::WorkerPool& pool,
                                              jobs::JobContext& context);

}  // namespace mane::rpc
