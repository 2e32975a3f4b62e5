#include "styling/map_sampler.h"

#include <algorithm>
#include <queue>
#include <utility>

#include "styling/map.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;

constexpr size_t kMostHalvings = 1 << 17;
constexpr double kWaste = 0.25;  // Part of proposals that may be in vain.

}  // namespace

MapSampler::MapSampler(const groom::HairRegion& region, const ScalpChart& chart,
                       const ScalpMap& map, Measure measure)
    : region_(region), chart_(chart), map_(map), measure_(measure) {
  const MapBounds bounds(map);
  cells_.reserve(region.patches());
  for (int i = 0; i < region.patches(); ++i) cells_.push_back(MakeCell(i, 0, 1, 0, 1, bounds));
  Refine(bounds);
  std::erase_if(cells_, [](const Cell& cell) { return cell.bounds.high == 0; });
  for (const Cell& cell : cells_) choice_.Add(cell.area * cell.bounds.high);
}

MapSampler::Cell MapSampler::MakeCell(int patch, double s0, double s1, double t0, double t1,
                                      const MapBounds& bounds) const {
  Cell cell{patch, s0, s1, t0, t1, region_.area_of(patch) * (s1 - s0) * (t1 - t0), {}};
  const Vector3d corners[] = {
      region_.At(patch, s0, t0).position, region_.At(patch, s0, t1).position,
      region_.At(patch, s1, t0).position, region_.At(patch, s1, t1).position};
  const Vector3d middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
  double radius = 0;
  for (const Vector3d& corner : corners) radius = std::max(radius, (corner - middle).norm());
  // A tenth more for the bend of an ellipsoid's cells; then what float32 takes from positions.
  radius = 1.1 * radius + 1e-7 * middle.cwiseAbs().sum();
  cell.bounds = bounds.Over(middle - chart_.center(), radius);
  if (measure_ == Measure::kSupport) {
    cell.bounds = {cell.bounds.low > 0 ? 1.0 : 0.0, cell.bounds.high > 0 ? 1.0 : 0.0};
  }
  return cell;
}

// Cuts across the longer direction.
std::pair<MapSampler::Cell, MapSampler::Cell> MapSampler::Halves(const Cell& cell,
                                                                 const MapBounds& bounds) const {
  const auto& [number, s0, s1, t0, t1, area, old] = cell;
  const auto patch = number;  // Which a lambda may name.
  const double s = 0.5 * (s0 + s1), t = 0.5 * (t0 + t1);
  const auto at = [&](double x, double y) { return region_.At(patch, x, y).position; };
  if ((at(s1, t) - at(s0, t)).norm() >= (at(s, t1) - at(s, t0)).norm()) {
    return {MakeCell(patch, s0, s, t0, t1, bounds), MakeCell(patch, s, s1, t0, t1, bounds)};
  }
  return {MakeCell(patch, s0, s1, t0, t, bounds), MakeCell(patch, s0, s1, t, t1, bounds)};
}

void MapSampler::Refine(const MapBounds& bounds) {
  std::priority_queue<std::pair<double, int>> worst;
  double waste = 0, proposed = 0;
  const auto add = [&](int i) {
    waste += cells_[i].waste();
    proposed += cells_[i].area * cells_[i].bounds.high;
    if (cells_[i].waste() > 0) worst.emplace(cells_[i].waste(), i);
  };
  for (int i = 0; i < static_cast<int>(cells_.size()); ++i) add(i);
  for (size_t n = 0; n < kMostHalvings && !worst.empty() && waste > kWaste * proposed; ++n) {
    const int i = worst.top().second;
    worst.pop();
    waste -= cells_[i].waste();
    proposed -= cells_[i].area * cells_[i].bounds.high;
    auto [one, other] = Halves(cells_[i], bounds);
    cells_[i] = one;
    add(i);
    cells_.push_back(other);
    add(static_cast<int>(cells_.size()) - 1);
  }
}

std::optional<groom::ScalpPoint> MapSampler::Propose(math::RandomStream& random) const {
  const Cell& cell = cells_[choice_.Choose(random)];
  const double s = random.Uniform(cell.s0, cell.s1), t = random.Uniform(cell.t0, cell.t1);
  const double level = random.Uniform() * cell.bounds.high;
  groom::ScalpPoint point = region_.At(cell.patch, s, t);
  point.position = point.position.cast<float>().cast<double>();
  if (cell.bounds.low == cell.bounds.high) return point;
  const double value = ValueAt(map_, chart_.At(point.position));
  const bool taken = measure_ == Measure::kSupport ? value > 0 : level < value;
  return taken ? std::optional(point) : std::nullopt;
}

}  // namespace mane::styling
