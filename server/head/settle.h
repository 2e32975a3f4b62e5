#pragma once

#include <memory>
#include <vector>

#include "base/cancelled.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/bodies.h"
#include "rod/batch.h"

namespace mane::head {

/// The shape in which hair of `groom` lies still among `bodies` on an upright head: its rest shape
/// settles in thick air, then in its own; where it leads through a body, hair falls on it from its
/// natural shape, or, where that does, too, from above.
/// A function of the groom and the bodies alone. Sets Bodies::settled, standing still, and
/// Bodies::settled_memory.
///
/// @return kCancelled within a step once `cancelled` says so.
Result<void> Settle(const groom::Groom& groom, const std::shared_ptr<Bodies>& bodies,
                    exec::WorkerPool& pool, const base::Cancelled& cancelled);

}  // namespace mane::head
