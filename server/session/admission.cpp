#include "session/admission.h"

namespace mane::session {

Result<void> AdmitHead(const groom::Groom& groom, const HeadOptions& options) {
  const size_t bytes = head::FrameSize(groom, options.view);
  if (bytes > kMaxFrameBytes) {
    return Error{ErrorCode::kResourceExhausted,
                 fmt::format("a frame of open.points_per_guide {} has {} bytes; at most {} are "
                             "allowed: ask for fewer points or a smaller format",
                             options.view.points_per_guide, bytes, kMaxFrameBytes),
                 "open.points_per_guide"};
  }
  const double work = static_cast<double>(groom.element_count()) * options.substeps;
  if (work <= kMaxFrameWork) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("{} elements in open.substeps {} are {} element-steps a frame; at most "
                           "{} are allowed",
                           groom.element_count(), options.substeps, work, kMaxFrameWork),
               "open.substeps"};
}

Result<void> AdmitFrame(const groom::Groom& groom, const head::Movement& movement) {
  const double work = static_cast<double>(groom.element_count()) * head::StepCount(movement);
  if (work <= kMaxFrameWork) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("pose.time_s is {} s after the last one, {} element-steps; at most {} "
                           "are allowed in one frame: send poses closer together",
                           movement.duration, work, kMaxFrameWork),
               "pose.time_s"};
}

double RealtimeLoad(const groom::Groom& groom, const HeadOptions& options) {
  if (options.pacing != Pacing::kRealtime) return 0;
  const int steps = options.substeps + (options.diagnostics ? kDiagnosticsSteps : 0);
  return static_cast<double>(groom.element_count()) * steps * options.rate_hz;
}

}  // namespace mane::session
