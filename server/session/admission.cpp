#include "session/admission.h"

#include <algorithm>

#include "head/beams.h"
#include "head/memory.h"
#include "head/wisps.h"

namespace mane::session {
namespace {

// A frame of a head; in lockstep, where poses decide, the shortest one.
head::Movement ShortestOf(const HeadOptions& options) {
  return {{}, options.pacing == Pacing::kRealtime ? 1 / options.rate_hz : 0, options.substeps};
}

// Points that a frame of `view` holds.
double PointCount(const groom::Groom& groom, const head::View& view) {
  if (view.format == head::FrameFormat::kGeneralized) return groom.element_count();
  return static_cast<double>(groom.guide_count()) * view.points_per_guide;
}

// Says what a time step of `groom` is made of, as what is too much is to be told.
std::string WhatSteps(const groom::Groom& groom, const head::ModelOptions& model = {}) {
  if (model.model == head::Model::kBeam) {
    return fmt::format("{} guides of {} segments", groom.guide_count(),
                       head::SegmentsOf(groom, model.beam));
  }
  std::string what = fmt::format("{} elements", groom.stepped_elements());
  if (!groom.has_contact) return what;
  const head::BodyCount count = head::CountBodies(groom);
  if (count.bodies > 0) {
    what += fmt::format(" that meet {} bodies, of which {} move on their own or as one",
                        count.bodies, count.groups);
  }
  if (head::HasWisps(groom))
    what += fmt::format(", of {} guides whose wisps meet", groom.guide_count());
  return what;
}

// What is less work for a frame of `groom`.
std::string LessWork(const groom::Groom& groom, const head::Movement& movement,
                     const head::ModelOptions& model) {
  if (StepWork(groom, movement.substeps, model) > kMaxFrameWork && movement.substeps > 1) {
    return "use fewer substeps";
  }
  if (model.model == head::Model::kBeam) return "use fewer guides or segments";
  std::string less = "use fewer guides or elements";
  if (groom.has_contact && head::CountBodies(groom).bodies > 1) less += ", fewer bodies";
  if (groom.has_contact && head::HasWisps(groom)) less += ", no wisps";
  return less;
}

// The error for a frame of too much work, `what` of which takes the steps of `movement`.
Error TooMuchWork(const groom::Groom& groom, const head::Movement& movement,
                  const head::ModelOptions& model, const std::string& what,
                  const std::string& instead, const std::string& field) {
  const int steps = head::StepCount(movement);
  return {ErrorCode::kResourceExhausted,
          fmt::format("{} takes {} time steps of {}, {:.0f} element-steps; at most {:.0f} are "
                      "allowed in one frame: {}",
                      what, steps, WhatSteps(groom, model), StepWork(groom, steps, model),
                      kMaxFrameWork, instead),
          field};
}

}  // namespace

double StepWork(const groom::Groom& groom, int steps, const head::ModelOptions& model) {
  if (model.model == head::Model::kBeam) {
    return kBeamSteps * groom.guide_count() * head::SegmentsOf(groom, model.beam) * steps;
  }
  double each = 1;
  if (groom.has_contact) {
    const head::BodyCount count = head::CountBodies(groom);
    each = kContactSteps + kGroupSteps * std::max(0, count.groups - 1) +
           kBodySteps * (count.bodies - count.groups);
    if (head::HasWisps(groom)) each += std::min(kWispSteps * groom.guide_count(), kMostWispSteps);
  }
  return static_cast<double>(groom.stepped_elements()) * steps * each;
}

size_t HeadBytes(const groom::Groom& groom, const HeadOptions& options) {
  const bool beams = options.model.model == head::Model::kBeam || options.may_shed;
  return head::StateBytes(groom) + (beams ? head::BeamBytes(groom, options.model.beam) : 0);
}

Result<void> AdmitState(const groom::Groom& groom, const std::string& field) {
  const size_t bytes = head::StateBytes(groom);
  if (bytes <= kMaxStateBytes) return {};
  return Error{
      ErrorCode::kResourceExhausted,
      fmt::format("the hair of a head of this groom, {}, remembers {} bytes; at most {} are "
                  "allowed: use fewer moving bodies, guides or elements",
                  WhatSteps(groom), bytes, kMaxStateBytes),
      field};
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
  if (const auto ok = AdmitState(groom, "open.groom"); !ok) return ok;
  const head::Movement shortest = ShortestOf(options);
  if (StepWork(groom, head::StepCount(shortest), options.model) <= kMaxFrameWork) return {};
  return TooMuchWork(groom, shortest, options.model,
                     fmt::format("a frame with open.substeps {}", options.substeps),
                     LessWork(groom, shortest, options.model),
                     options.substeps > 1 ? "open.substeps" : "open.groom");
}

int FrameWindow(const groom::Groom& groom, const head::View& view, int most) {
  const size_t bytes = std::max<size_t>(1, head::FrameSize(groom, view));
  return static_cast<int>(std::clamp<size_t>(kMaxBacklogBytes / bytes, 1, most));
}

Result<void> AdmitFrame(const groom::Groom& groom, const head::Movement& movement,
                        const head::ModelOptions& model) {
  if (StepWork(groom, head::StepCount(movement), model) <= kMaxFrameWork) return {};
  return TooMuchWork(groom, movement, model,
                     fmt::format("pose.time_s, {:.6g} s after the last one,", movement.duration),
                     "send poses closer together", "pose.time_s");
}

Result<void> AdmitBakedFrame(const groom::Groom& groom, const head::Movement& movement, int frame,
                             const head::ModelOptions& model) {
  if (StepWork(groom, head::StepCount(movement), model) <= kMaxFrameWork) return {};
  const std::string what = fmt::format("frame {}, {:.6g} s after the last one, with substeps {}",
                                       frame, movement.duration, movement.substeps);
  if (StepWork(groom, 1, model) > kMaxFrameWork) {
    return TooMuchWork(groom, movement, model, what,
                       LessWork(groom, {{}, movement.duration, 1}, model), "groom");
  }
  if (StepWork(groom, movement.substeps, model) > kMaxFrameWork) {
    return TooMuchWork(groom, movement, model, what, LessWork(groom, movement, model), "substeps");
  }
  return TooMuchWork(groom, movement, model, what, "put poses closer together",
                     fmt::format("motion.times_s[{}]", frame));
}

double RealtimeLoad(const groom::Groom& groom, const HeadOptions& options) {
  if (options.pacing != Pacing::kRealtime) return 0;
  const int diagnostics = options.diagnostics ? kDiagnosticsSteps : 0;
  const double frame = StepWork(groom, head::StepCount(ShortestOf(options)), options.model) +
                       kFrameSteps + static_cast<double>(groom.stepped_elements()) * diagnostics +
                       kPointSteps * PointCount(groom, options.view);
  return frame * options.rate_hz;
}

}  // namespace mane::session
