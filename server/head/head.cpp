#include "head/head.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <span>

#include "base/check.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

// Guides advanced in one piece by one worker: enough to outweigh handing it over, few enough to
// share a head of a hundred guides among several.
constexpr int kGuidesPerPiece = 8;

rod::StrandState StrandOf(const groom::Groom& groom, int guide, HeadState* state) {
  const size_t first = groom.first_element[guide];
  const size_t N = groom.first_element[guide + 1] - first;
  return {std::span(state->theta).subspan(first, N), std::span(state->rate).subspan(first, N),
          std::span(state->velocity).subspan(first * rod::kGaussPoints, N * rod::kGaussPoints)};
}

void PutToRest(const groom::Groom& groom, int guide, HeadState* state) {
  const rod::StrandState strand = StrandOf(groom, guide, state);
  std::copy_n(groom.rest_theta.begin() + groom.first_element[guide], strand.theta.size(),
              strand.theta.begin());
  std::ranges::fill(strand.rate, Vector3d::Zero());
  std::ranges::fill(strand.velocity, Vector3d::Zero());
}

// All time steps of one guide. False when it had to be put to rest.
bool AdvanceGuide(const groom::Groom& groom, int guide, const Movement& movement, int steps,
                  const Environment& environment, HeadState* state) {
  thread_local rod::StepScratch scratch;
  const groom::Guide& description = groom.guides[guide];
  const rod::StrandState strand = StrandOf(groom, guide, state);
  math::Pose begin = state->pose;
  for (int i = 1; i <= steps; ++i) {
    const math::Pose end = i == steps
                               ? movement.target
                               : math::Interpolate(state->pose, movement.target, double(i) / steps);
    const rod::ClampMotion clamp{begin * description.root, end * description.root,
                                 movement.duration / steps};
    if (!rod::Step(description.strand, clamp, environment, strand, scratch)) {
      PutToRest(groom, guide, state);
      return false;
    }
    begin = end;
  }
  return true;
}

}  // namespace

int StepCount(const Movement& movement) {
  // The tolerance keeps a duration of one longest step, rounded up, whole.
  const double longest = std::ceil(movement.duration / kLongestStep - 1e-6);
  return movement.substeps * std::max(1, static_cast<int>(longest));
}

HeadState AtRest(const groom::Groom& groom, const math::Pose& pose) {
  HeadState state;
  state.pose = pose;
  state.theta = groom.rest_theta;
  state.rate.assign(groom.element_count(), Vector3d::Zero());
  state.velocity.assign(size_t(groom.element_count()) * rod::kGaussPoints, Vector3d::Zero());
  return state;
}

void Reset(const groom::Groom& groom, HeadState* state) { *state = AtRest(groom, state->pose); }

void Teleport(const math::Pose& pose, HeadState* state) {
  const Eigen::Quaterniond turn = pose.q * state->pose.q.conjugate();
  for (Vector3d& u : state->velocity) u = turn * u;
  state->pose = pose;
}

StepReport Advance(const groom::Groom& groom, const Movement& movement,
                   const Environment& environment, HeadState* state, exec::WorkerPool& pool) {
  MANE_CHECK(movement.duration > 0 && movement.substeps >= 1);
  MANE_CHECK(static_cast<int>(state->theta.size()) == groom.element_count());
  const int steps = StepCount(movement);
  std::atomic<int> repaired = 0;
  pool.ParallelFor(groom.guide_count(), kGuidesPerPiece, [&](int begin, int end) {
    for (int guide = begin; guide < end; ++guide) {
      if (!AdvanceGuide(groom, guide, movement, steps, environment, state)) ++repaired;
    }
  });
  state->pose = movement.target;
  return {repaired};
}

}  // namespace mane::head
