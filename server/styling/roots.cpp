#include "styling/roots.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "base/check.h"
#include "groom/blue_noise.h"
#include "groom/hair_region.h"
#include "math/random.h"
#include "styling/map_sampler.h"
#include "styling/nearest.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using groom::ScalpPoint;

constexpr int kCandidatesPerMaster = 10;
constexpr int kFewestCandidates = 200;
constexpr int kGrain = 1024;  // Strands of a piece.
// Proposals made on trial, and how many of them must be taken: one of 256, or drawing takes long.
constexpr int kTrials = 4096;
constexpr int kFewestTaken = 16;

// Of the seeds that are made of the given one: other parts of a style use it too.
enum SeedStream : uint64_t { kTrial = 0x726f6f7473, kMasters, kMembers };

Result<void> CheckDrawing(const MapSampler& sampler, uint64_t seed) {
  const char* field = "density";
  if (sampler.empty()) {
    return InvalidArgument(field, "density is 0 wherever hair grows; it must be above 0 somewhere");
  }
  math::RandomStream random(seed, kTrial);
  int taken = 0;
  for (int i = 0; i < kTrials; ++i) taken += sampler.Propose(random).has_value();
  if (taken >= kFewestTaken) return {};
  return InvalidArgument(field,
                         "density is 0 or next to 0 almost wherever hair grows, or varies too "
                         "sharply to draw hair by it");
}

// Draws until a proposal is taken; adds to `*tries`.
ScalpPoint Draw(const MapSampler& sampler, math::RandomStream& random, int64_t* tries) {
  while (true) {
    ++*tries;
    if (std::optional<ScalpPoint> point = sampler.Propose(random)) return *point;
  }
}

// (P7)
std::vector<ScalpPoint> PlaceMasters(const MapSampler& sampler, int count, uint64_t seed) {
  const int m = std::max(kCandidatesPerMaster * count, kFewestCandidates);
  std::vector<ScalpPoint> candidates;
  std::vector<Vector3d> positions;
  candidates.reserve(m);
  positions.reserve(m);
  math::RandomStream random(seed, kMasters);
  int64_t tries = 0;
  for (int i = 0; i < m; ++i) {
    candidates.push_back(Draw(sampler, random, &tries));
    positions.push_back(candidates.back().position);
  }
  const double area = sampler.proposed() * m / static_cast<double>(tries);
  std::vector<ScalpPoint> masters;
  masters.reserve(count);
  for (const int i : groom::EliminateToBlueNoise(positions, count, area)) {
    masters.push_back(candidates[i]);
  }
  return masters;
}

// (P8): draws members and gives each to its wisp, wisp by wisp and within it in the order drawn.
void PlaceMembers(const MapSampler& sampler, int count, uint64_t seed, exec::WorkerPool& pool,
                  Roots* roots) {
  std::vector<Vector3d> masters;
  masters.reserve(roots->masters.size());
  for (const ScalpPoint& master : roots->masters) masters.push_back(master.position);
  const NearestPoint nearest(masters);

  std::vector<Eigen::Vector3f> positions(count);
  std::vector<int> wisps(count);
  const uint64_t member_seed = math::RandomStream(seed, kMembers).Bits();
  pool.ParallelFor(count, kGrain, [&](int begin, int end) {
    int64_t tries = 0;
    for (int i = begin; i < end; ++i) {
      math::RandomStream random(member_seed, i);
      const Vector3d position = Draw(sampler, random, &tries).position;
      positions[i] = position.cast<float>();
      wisps[i] = nearest.Find(position);
    }
  });

  std::vector<uint32_t>& first = roots->first_member;
  first.assign(roots->masters.size() + 1, 0);
  for (const int wisp : wisps) ++first[wisp + 1];
  for (size_t w = 1; w < first.size(); ++w) first[w] += first[w - 1];
  std::vector<uint32_t> next(first.begin(), first.end() - 1);
  roots->members.resize(count);
  for (int i = 0; i < count; ++i) roots->members[next[wisps[i]]++] = positions[i];
}

}  // namespace

Result<Roots> PlaceRoots(const groom::Scalp& scalp, const ScalpChart& chart,
                         const ScalpMap& density, int wisp_count, int strand_count, uint64_t seed,
                         exec::WorkerPool& pool) {
  MANE_CHECK(wisp_count >= 1 && strand_count >= 0);
  const groom::HairRegion region(scalp);
  Roots roots;
  {
    const MapSampler even(region, chart, density, MapSampler::Measure::kSupport);
    if (auto ok = CheckDrawing(even, seed); !ok) return ok.error();
    roots.masters = PlaceMasters(even, wisp_count, seed);
  }
  const MapSampler by_density(region, chart, density, MapSampler::Measure::kValue);
  if (auto ok = CheckDrawing(by_density, seed); !ok) return ok.error();
  PlaceMembers(by_density, strand_count, seed, pool, &roots);
  return roots;
}

}  // namespace mane::styling
