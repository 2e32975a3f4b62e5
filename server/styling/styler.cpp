#include "styling/styler.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace mane::styling {
namespace {

using Eigen::Vector3d;

double DistanceToSegment(const Vector3d& x, const Vector3d& from, const Vector3d& to) {
  const Vector3d along = to - from;
  const double squared = along.squaredNorm();
  const double t = squared > 0 ? std::clamp((x - from).dot(along) / squared, 0.0, 1.0) : 0;
  return (x - from - t * along).norm();
}

// Whether others wait for those who are on their way: not where nothing pulls at them.
bool Holds(const Constraint& constraint) {
  return constraint.kind != Constraint::Kind::kDirection && constraint.weight > 0;
}

}  // namespace

Styler::Styler(const std::vector<ConstraintQueue>& queues,
               const std::vector<std::vector<uint32_t>>& selected, int wisps, double segment_length)
    : queues_(queues),
      selected_(selected),
      state_(static_cast<size_t>(wisps)),
      segment_length_(segment_length) {
  for (size_t q = 0; q < queues.size(); ++q) {
    auto& paths = paths_.emplace_back();
    for (const Constraint& constraint : queues[q].constraints) paths.emplace_back(constraint.path);
    for (const uint32_t wisp : selected[q]) state_[wisp].queue = static_cast<int32_t>(q);
  }
}

bool Styler::Working(const State& state) const {
  return state.queue >= 0 && static_cast<size_t>(state.phase) <
                                 queues_[static_cast<size_t>(state.queue)].constraints.size();
}

void Styler::Begin(uint32_t wisp, const Vector3d& root) {
  if (Working(state_[wisp])) Start(wisp, root);
}

void Styler::Start(uint32_t wisp, const Vector3d& joint) {
  State& state = state_[wisp];
  state.starts = state.inside = state.met = false;
  FindPlace(&state, joint);
  state.met = Meets(state, joint, joint);
}

// A wisp that follows a path looks ahead only, so that it stays in its turn where the path comes
// near itself.
void Styler::FindPlace(State* state, const Vector3d& x) const {
  const Constraint& constraint = Of(*state);
  const Path& path = paths_[static_cast<size_t>(state->queue)][static_cast<size_t>(state->phase)];
  const double a = std::max(constraint.radius, segment_length_);
  const bool follows = constraint.kind == Constraint::Kind::kTrajectory && state->inside;
  state->place =
      follows ? path.Nearest(x, state->place.arc, std::min(path.length(), state->place.arc + 2 * a))
              : path.Nearest(x);
  const bool trajectory = constraint.kind == Constraint::Kind::kTrajectory;
  if (state->place.distance <= (trajectory ? a : constraint.radius)) state->inside = true;
}

bool Styler::Meets(const State& state, const Vector3d& from, const Vector3d& to) const {
  const Constraint& constraint = Of(state);
  const double length =
      paths_[static_cast<size_t>(state.queue)][static_cast<size_t>(state.phase)].length();
  const PathPlace& place = state.place;
  switch (constraint.kind) {
    case Constraint::Kind::kPoint:
      return DistanceToSegment(constraint.path[0], from, to) <= constraint.radius;
    case Constraint::Kind::kTrajectory: {
      if (!state.inside) return false;
      const double near_end = length - std::max(constraint.radius, segment_length_);
      if (place.distance <= constraint.radius && place.arc >= near_end) return true;
      return DistanceToSegment(constraint.path.back(), from, to) <= constraint.radius;
    }
    case Constraint::Kind::kDirection: {
      if (!state.inside) return false;
      const bool past = place.arc >= length && (to - place.point).dot(place.tangent) > 0;
      return past || place.distance > constraint.radius;
    }
  }
  return false;
}

Styler::Pull Styler::PullOf(uint32_t wisp, const Vector3d& x) const {
  const State& state = state_[wisp];
  if (!Working(state)) return {};
  const Constraint& constraint = Of(state);
  const Path& path = paths_[static_cast<size_t>(state.queue)][static_cast<size_t>(state.phase)];
  const Vector3d psi = Psi(constraint, path, state.place, x, segment_length_);
  // (7) taken literally would weaken Phi also where a direction says nothing.
  if (psi.isZero() || constraint.weight == 0) return {};
  return {constraint.weight, psi, constraint.kind != Constraint::Kind::kDirection};
}

void Styler::Grown(uint32_t wisp, const Vector3d& from, const Vector3d& to) {
  State& state = state_[wisp];
  if (!Working(state)) return;
  FindPlace(&state, to);
  state.met = Meets(state, from, to);
}

// Wisps that have met their constraint and need not wait go on to the next; whether there are any.
bool Styler::Release(size_t queue) {
  int32_t barrier = std::numeric_limits<int32_t>::max();
  for (const uint32_t wisp : selected_[queue]) {
    const State& state = state_[wisp];
    if (state.met || state.ended || !Working(state)) continue;
    if (!Holds(Of(state))) continue;
    barrier = std::min(barrier, state.phase);
  }
  bool any = false;
  for (const uint32_t wisp : selected_[queue]) {
    State& state = state_[wisp];
    if (!state.met) continue;
    if (Holds(Of(state)) && state.phase >= barrier) continue;
    state.met = false;
    ++state.phase;
    state.starts = Working(state);
    any = true;
  }
  return any;
}

std::vector<std::vector<ConstraintReport>> Styler::Report() const {
  std::vector<std::vector<ConstraintReport>> report(queues_.size());
  for (size_t q = 0; q < queues_.size(); ++q) {
    report[q].resize(queues_[q].constraints.size());
    for (const uint32_t wisp : selected_[q]) {
      const State& state = state_[wisp];
      const int met = state.phase + (state.met ? 1 : 0);
      for (size_t i = 0; i < report[q].size(); ++i) {
        ++report[q][i].selected;
        ++(static_cast<int>(i) < met ? report[q][i].met : report[q][i].missed);
      }
    }
  }
  return report;
}

}  // namespace mane::styling
