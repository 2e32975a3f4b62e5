#include "groom/sampler.h"

#include <algorithm>
#include <limits>

#include "base/check.h"
#include "groom/blue_noise.h"
#include "math/random.h"

namespace mane::groom {
namespace {

constexpr uint64_t kSamplerStream = std::numeric_limits<uint64_t>::max();  // No guide's index.
constexpr int kCandidatesPerPoint = 10;
constexpr int kFewestCandidates = 200;

}  // namespace

double HairArea(const Scalp& scalp) { return HairRegion(scalp).area(); }

std::vector<ScalpPoint> SampleScalp(const Scalp& scalp, int n, uint64_t seed) {
  MANE_CHECK(n >= 1);
  const HairRegion region(scalp);
  math::RandomStream random(seed, kSamplerStream);
  const int m = std::max(kCandidatesPerPoint * n, kFewestCandidates);
  std::vector<ScalpPoint> candidates;
  std::vector<Eigen::Vector3d> positions;
  candidates.reserve(m);
  positions.reserve(m);
  for (int i = 0; i < m; ++i) {
    candidates.push_back(region.Draw(random));
    positions.push_back(candidates.back().position);
  }
  std::vector<ScalpPoint> points;
  points.reserve(n);
  for (const int i : EliminateToBlueNoise(positions, n, region.area())) {
    points.push_back(candidates[i]);
  }
  return points;
}

}  // namespace mane::groom
