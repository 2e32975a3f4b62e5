#pragma once

#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "mane/v1/groom.pb.h"

namespace mane::rpc {

/// Answers GroomService.ComputeRestShape for `groom`; guides are solved in parallel on `pool`.
Result<void> ComputeRest(const groom::Groom& groom, const v1::ComputeRestShapeRequest& request,
                         exec::WorkerPool& pool, v1::ComputeRestShapeResponse* response);

}  // namespace mane::rpc
