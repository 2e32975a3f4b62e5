#pragma once

#include "base/result.h"
#include "head/head.h"
#include "session/command.h"

namespace mane::session {

/// What one head may cost, so that it cannot hold up the others: a frame, once begun, is computed
/// to its end. Costs count in element-steps, one time step of one element, a microsecond or so.

/// Element-steps that the diagnostics of one element count as.
inline constexpr int kDiagnosticsSteps = 64;

/// Element-steps of one lockstep frame: seconds of work at most.
inline constexpr double kMaxFrameWork = 1e7;
/// Bytes of one frame; several may wait for a slow lockstep client.
inline constexpr size_t kMaxFrameBytes = 16 << 20;

/// kResourceExhausted when a frame of `options` is too large or even its shortest one too much
/// work.
Result<void> AdmitHead(const groom::Groom& groom, const HeadOptions& options);

/// kResourceExhausted when `movement` is too much work for one frame.
Result<void> AdmitFrame(const groom::Groom& groom, const head::Movement& movement);

/// Element-steps a second of a real-time head; 0 in lockstep.
[[nodiscard]] double RealtimeLoad(const groom::Groom& groom, const HeadOptions& options);

}  // namespace mane::session
