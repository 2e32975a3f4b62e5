// The passes of a step after the first: impulses from the velocities that the last ones gave.

#include <algorithm>
#include <utility>

#include "contact/wisp_approach.h"
#include "contact/wisp_ends.h"
#include "contact/wisp_impulse.h"
#include "contact/wisp_pairs.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;

// Pairs that are revised alone in a pass: so many, and one more for so many guides.
constexpr size_t kMostPassing = 8, kGuidesToOnePassing = 200;

// (H11): what the last change of impulses tells of a guide's mass.
void WeighGuide(size_t guide, std::span<const WispPair> pairs, int pass, const WispScratch& scratch,
                std::vector<Heaviness>& heaviness) {
  Weighing weighing;
  ForPairsOf(guide, scratch, [&](size_t pair, int side) { weighing.Add(pairs[pair], side, pass); });
  weighing.Finish(heaviness[guide]);
}

// By how much the two are nearer than what nearly passes, after a step that gives these velocities
// [m]; 0 where they are not, or were before it.
float PassesBy(const WispPair& pair, const VelocitySpans& velocities, float dt) {
  const Vector3f w = SideVelocity(pair, 0, velocities) - SideVelocity(pair, 1, velocities);
  const float by = pair.passing_gap - pair.gap - dt * w.dot(pair.normal);
  return pair.gap > pair.passing_gap && by > 0 ? by : 0;
}

// Lists the pairs that would nearly pass, the worst of them if they are many, and their guides.
void FindPassing(std::span<const WispPair> pairs, const VelocitySpans& velocities, float dt,
                 exec::WorkerPool& pool, WispScratch& scratch) {
  const auto count = static_cast<int>(pairs.size());
  pool.ParallelFor(count, kPairsAPiece, [&](int begin, int end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      scratch.passing_by[i] = PassesBy(pairs[i], velocities, dt);
    }
  });
  auto& passing = scratch.passing;
  auto& guides = scratch.revised;
  passing.clear(), guides.clear();
  for (int i = 0; i < count; ++i) {
    const float by = scratch.passing_by[static_cast<size_t>(i)];
    if (by > 0) passing.push_back({by, i});
  }
  const size_t most = kMostPassing + scratch.first_point.size() / kGuidesToOnePassing;
  KeepRoom(passing);
  if (passing.size() > most) {
    std::ranges::nth_element(passing, passing.begin() + static_cast<ptrdiff_t>(most), {},
                             [](const auto& each) { return std::pair(-each.by, each.pair); });
    passing.resize(most);
  }
  for (const auto& [by, i] : passing) {
    const auto& guide = pairs[static_cast<size_t>(i)].guide;
    guides.insert(guides.end(), {guide[0], guide[1]});
  }
  std::ranges::sort(guides);
  guides.erase(std::unique(guides.begin(), guides.end()), guides.end());
}

}  // namespace

void WispTracker::Revise(const VelocitySpans& velocities, WispScratch& scratch,
                         exec::WorkerPool& pool, const ImpulseSpans& impulses) {
  const auto for_pairs = [&](const auto& visit) {
    pool.ParallelFor(static_cast<int>(pairs_.size()), kPairsAPiece, [&](int begin, int end) {
      for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) visit(pairs_[i]);
    });
  };
  for_pairs([&](WispPair& pair) {
    for (int k = 0; k < 2; ++k) pair.velocity[k] = SideVelocity(pair, k, velocities);
  });
  pool.ParallelFor(static_cast<int>(heaviness_.size()), WispScratch::kGuidesAPiece,
                   [&](int begin, int end) {
                     for (auto g = static_cast<size_t>(begin); g < static_cast<size_t>(end); ++g) {
                       WeighGuide(g, pairs_, passes_, scratch, heaviness_);
                     }
                   });
  for_pairs([&](WispPair& pair) {
    SetMasses(heaviness_, pair);
    ReviseImpulse(pair);
  });
  ++passes_;
  SpreadImpulses(pairs_, scratch, pool, impulses);
}

std::span<const int32_t> WispTracker::RevisePassing(const VelocitySpans& velocities,
                                                    WispScratch& scratch, exec::WorkerPool& pool,
                                                    const ImpulseSpans& impulses) {
  FindPassing(pairs_, velocities, static_cast<float>(last_dt_), pool, scratch);
  const auto& guides = scratch.revised;
  if (guides.empty()) return {};
  for (const int32_t g : guides) {
    ForPairsOf(static_cast<size_t>(g), scratch, [&](size_t i, int) {
      for (int k = 0; k < 2; ++k) pairs_[i].velocity[k] = SideVelocity(pairs_[i], k, velocities);
    });
  }
  // What is revised alone tells how heavy a guide is whose neighbours stay as they are: it is not
  // remembered.
  scratch.heaviness = heaviness_;
  for (const int32_t g : guides) {
    WeighGuide(static_cast<size_t>(g), pairs_, passes_, scratch, scratch.heaviness);
  }
  for (const int32_t g : guides) {
    ForPairsOf(static_cast<size_t>(g), scratch, [&](size_t i, int) {
      pairs_[i].last_impulse = pairs_[i].impulse;
      pairs_[i].last_velocity = pairs_[i].velocity;
    });
  }
  for (const auto& [by, i] : scratch.passing) {
    WispPair& pair = pairs_[static_cast<size_t>(i)];
    SetMasses(scratch.heaviness, pair);
    ReviseImpulse(pair);
  }
  ++passes_;
  for (const int32_t g : guides) {
    const auto first = scratch.first_point.begin() + g;
    SpreadImpulses(first[0], first[1], pairs_, scratch, impulses);
  }
  return guides;
}

}  // namespace mane::contact
