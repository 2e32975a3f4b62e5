// The passes of a step after the first: impulses from the velocities that the last ones gave.

#include <algorithm>

#include "contact/wisp_approach.h"
#include "contact/wisp_ends.h"
#include "contact/wisp_impulse.h"
#include "contact/wisp_pairs.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;

constexpr uint8_t kPasses = 1, kRevised = 2;  // In WispScratch::passing.

// (H11): what the last change of impulses tells of a guide's mass.
void WeighGuide(size_t guide, std::span<const WispPair> pairs, int pass, const WispScratch& scratch,
                std::vector<Heaviness>& heaviness) {
  Weighing weighing;
  ForPairsOf(guide, scratch, [&](size_t pair, int side) { weighing.Add(pairs[pair], side, pass); });
  weighing.Finish(heaviness[guide]);
}

// Whether the two nearly pass through each other in a step that gives these velocities.
bool Passes(const WispPair& pair, const VelocitySpans& velocities, float dt) {
  const Vector3f w = SideVelocity(pair, 0, velocities) - SideVelocity(pair, 1, velocities);
  const float way = dt * w.dot(pair.normal);
  return pair.gap > pair.passing && pair.gap + way < pair.passing;
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
  const auto dt = static_cast<float>(last_dt_);
  auto& passing = scratch.passing;
  auto& guides = scratch.revised;
  pool.ParallelFor(static_cast<int>(pairs_.size()), kPairsAPiece, [&](int begin, int end) {
    for (auto i = static_cast<size_t>(begin); i < static_cast<size_t>(end); ++i) {
      passing[i] = Passes(pairs_[i], velocities, dt) ? kPasses : 0;
    }
  });
  guides.clear();
  for (size_t i = 0; i < pairs_.size(); ++i) {
    if (passing[i] == 0) continue;
    guides.insert(guides.end(), {pairs_[i].guide[0], pairs_[i].guide[1]});
  }
  KeepRoom(guides);
  std::ranges::sort(guides);
  const auto same = std::ranges::unique(guides);
  guides.erase(same.begin(), same.end());

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
      WispPair& pair = pairs_[i];
      if (passing[i] == kPasses) {
        SetMasses(scratch.heaviness, pair);
        ReviseImpulse(pair);
        passing[i] = kRevised;  // Its other guide's turn comes, too.
      } else if (passing[i] != kRevised) {
        pair.last_impulse = pair.impulse;
        pair.last_velocity = pair.velocity;
      }
    });
  }
  passes_ += guides.empty() ? 0 : 1;
  for (const int32_t g : guides) {
    const auto first = scratch.first_point.begin() + g;
    SpreadImpulses(first[0], first[1], pairs_, scratch, impulses);
  }
  return guides;
}

}  // namespace mane::contact
