#include "styling/members.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "base/check.h"
#include "styling/distribution.h"
#include "styling/wisp_grower.h"

namespace mane::styling {
namespace {

constexpr int kGrain = 8;  // Wisps a piece.

// Places for as many points as any strand can get, (strands + 1).
std::vector<size_t> Places(const Roots& roots, const Masters& masters) {
  std::vector<size_t> first{0};
  first.reserve(roots.members.size() + 1);
  for (int wisp = 0; wisp < roots.wisps(); ++wisp) {
    const uint32_t joints = masters.first_joint[wisp + 1] - masters.first_joint[wisp];
    MANE_CHECK(joints >= 2);
    for (uint32_t i = roots.first_member[wisp]; i < roots.first_member[wisp + 1]; ++i) {
      first.push_back(first.back() + joints);
    }
  }
  return first;
}

}  // namespace

float RadiusAt(std::span<const double> radii, double s) {
  const double at = std::clamp(s, 0.0, 1.0) * static_cast<double>(radii.size() - 1);
  const auto i = static_cast<size_t>(at);
  if (i + 1 >= radii.size()) return static_cast<float>(radii.back());
  return static_cast<float>(radii[i] + (at - static_cast<double>(i)) * (radii[i + 1] - radii[i]));
}

double Reach(const Distribution& length, double master_length, std::span<const double> radii) {
  const double widest = radii.empty() ? 0 : *std::max_element(radii.begin(), radii.end());
  return master_length * std::max(1.0, Quantile(length).high()) + std::numbers::pi * widest;
}

Members MakeMembers(const Roots& roots, const Masters& masters, const Obstacles& obstacles,
                    const Distribution& length, std::span<const double> radii, double fuzziness,
                    uint64_t seed, exec::WorkerPool& pool, const base::Cancelled& cancelled) {
  MANE_CHECK(roots.wisps() == masters.wisps() && !radii.empty());
  const Quantile quantile(length);
  const std::vector<size_t> place = Places(roots, masters);
  Members members;
  members.points.resize(place.back());
  std::vector<uint32_t> counts(roots.strands());
  pool.ParallelFor(roots.wisps(), kGrain, [&](int begin, int end) {
    WispGrower grower(masters, obstacles, quantile, radii, fuzziness, seed);
    for (int wisp = begin; wisp < end; ++wisp) {
      if (base::IsCancelled(cancelled)) return;
      const uint32_t first = roots.first_member[wisp];
      const uint32_t n = roots.first_member[wisp + 1] - first;
      if (n == 0) continue;
      grower.Grow(wisp, first, std::span(roots.members).subspan(first, n),
                  std::span(members.points).subspan(place[first], place[first + n] - place[first]),
                  std::span(counts).subspan(first, n));
    }
  });

  // Closes the gaps, in place: a strand only moves toward the front.
  members.first_point.resize(counts.size() + 1);
  size_t total = 0;
  for (size_t i = 0; i < counts.size(); ++i) {
    members.first_point[i] = static_cast<uint32_t>(total);
    const auto from = members.points.begin() + static_cast<std::ptrdiff_t>(place[i]);
    std::copy(from, from + counts[i], members.points.begin() + static_cast<std::ptrdiff_t>(total));
    total += counts[i];
  }
  members.first_point[counts.size()] = static_cast<uint32_t>(total);
  members.points.resize(total);
  members.points.shrink_to_fit();
  return members;
}

}  // namespace mane::styling
