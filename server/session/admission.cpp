#include "session/admission.h"

#include <algorithm>

#include "head/wisps.h"

namespace mane::session {
namespace {

// Time steps of a frame; in lockstep, where poses decide, of the shortest one.
int StepsOfFrame(const HeadOptions& options) {
  const double duration = options.pacing == Pacing::kRealtime ? 1 / options.rate_hz : 0;
  return head::StepCount({{}, duration, options.substeps});
}

// Points that a frame of `view` holds.
double PointCount(const groom::Groom& groom, const head::View& view) {
  if (view.format == head::FrameFormat::kGeneralized) return groom.element_count();
  return static_cast<double>(groom.guide_count()) * view.points_per_guide;
}

}  // namespace

double StepWork(const groom::Groom& groom, int steps) {
  double each = groom.has_contact ? kContactSteps : 1;
  if (groom.has_contact && head::HasWisps(groom)) each += kWispSteps * groom.guide_count();
  return static_cast<double>(groom.stepped_elements()) * steps * each;
}

Result<void> AdmitView(const groom::Groom& groom, const head::View& view,
                       const std::string& field) {
  const size_t bytes = head::FrameSize(groom, view);
  if (bytes <= kMaxFrameBytes) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("a frame of {}points_per_guide {} has {} bytes; at most {} are allowed: "
                           "ask for fewer points or a smaller format",
                           field, view.points_per_guide, bytes, kMaxFrameBytes),
               field + "points_per_guide"};
}

Result<void> AdmitHead(const groom::Groom& groom, const HeadOptions& options) {
  if (const auto ok = AdmitView(groom, options.view, "open."); !ok) return ok;
  const int steps = StepsOfFrame(options);
  const double work = StepWork(groom, steps);
  if (work <= kMaxFrameWork) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("{} elements in {} time steps, with open.substeps {}, are {} "
                           "element-steps a frame; at most {} are allowed",
                           groom.stepped_elements(), steps, options.substeps, work, kMaxFrameWork),
               "open.substeps"};
}

int FrameWindow(const groom::Groom& groom, const head::View& view, int most) {
  const size_t bytes = std::max<size_t>(1, head::FrameSize(groom, view));
  return static_cast<int>(std::clamp<size_t>(kMaxBacklogBytes / bytes, 1, most));
}

Result<void> AdmitFrame(const groom::Groom& groom, const head::Movement& movement) {
  const double work = StepWork(groom, head::StepCount(movement));
  if (work <= kMaxFrameWork) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("pose.time_s is {} s after the last one, {} element-steps; at most {} "
                           "are allowed in one frame: send poses closer together",
                           movement.duration, work, kMaxFrameWork),
               "pose.time_s"};
}

double RealtimeLoad(const groom::Groom& groom, const HeadOptions& options) {
  if (options.pacing != Pacing::kRealtime) return 0;
  const int diagnostics = options.diagnostics ? kDiagnosticsSteps : 0;
  const double frame = StepWork(groom, StepsOfFrame(options)) + kFrameSteps +
                       static_cast<double>(groom.stepped_elements()) * diagnostics +
                       kPointSteps * PointCount(groom, options.view);
  return frame * options.rate_hz;
}

}  // namespace mane::session
