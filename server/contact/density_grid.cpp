#include "contact/density_grid.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "rod/scheme.h"

namespace mane::contact {
namespace {

using FourInts [[gnu::vector_size(16)]] = int32_t;

constexpr int kMostCells = 64;          // Along an axis.
constexpr float kFarthest = 1e4f;       // From the origin [m].
constexpr float kFastest = 1e3f;        // Along an axis [m/s].
constexpr float kDensest = 1e30f;       // [kg/m^3]
constexpr float kLightest = 1e-12f;     // Of points [kg].
constexpr float kHeaviest = 1e6f;       // [kg]
constexpr float kLeastAround = 1e-30f;  // At a corner [kg]: less moves nothing.
constexpr float kLongestMove = 0.25f;   // That pressure may cause in a step, by the cell's side.
constexpr size_t kGroup = 8;            // Points.
constexpr int kPointsAPiece = 128 * kGroup;
constexpr int kPointsASlab = 4096;  // At least, where several workers scatter.

template <typename V>
V Min(const V& a, const V& b) {
  return a < b ? a : b;
}
template <typename V>
V Max(const V& a, const V& b) {
  return a > b ? a : b;
}
template <typename V>
V Lerp(const V& a, const V& b, float part) {
  return a + part * (b - a);
}

bool All(const FourInts& mask) {
  int64_t halves[2];
  std::memcpy(halves, &mask, sizeof(halves));
  return (halves[0] & halves[1]) == -1;
}

}  // namespace

template <typename Visit>
void DensityGrid::ForPoints(exec::WorkerPool& pool, const Visit& visit) const {
  pool.ParallelFor(static_cast<int>(points_.size()), kPointsAPiece, [&](int begin, int end) {
    visit(static_cast<size_t>(begin), static_cast<size_t>(end));
  });
}

template <typename Motion>
void DensityGrid::Read(const PointSpans& position, std::span<const float> mass,
                       exec::WorkerPool& pool, const Motion& motion) {
  points_.resize(mass.size());
  groups_.resize((mass.size() + kGroup - 1) / kGroup);
  ForPoints(pool, [this, position, mass, motion](size_t begin, size_t end) {
    constexpr Four kLow{-kFarthest, -kFarthest, -kFarthest, kLightest};
    constexpr Four kHigh{kFarthest, kFarthest, kFarthest, kHeaviest};
    constexpr Four kLeast{-kFastest, -kFastest, -kFastest, 0};
    constexpr Four kMost{kFastest, kFastest, kFastest, kDensest};
    Point* const points = points_.data();
    for (size_t first = begin; first < end; first += kGroup) {
      Four low = kHigh, high = kLow;
      for (size_t p = first; p < std::min(end, first + kGroup); ++p) {
        const Four place{position.x[p], position.y[p], position.z[p], mass[p]};
        if (!All((place >= kLow) & (place <= kHigh))) {
          points[p] = Point{};  // Without mass it gives and gets nothing.
          continue;
        }
        low = Min(low, place);
        high = Max(high, place);
        const Four u = motion(p);
        points[p] = {place, mass[p] * (((u >= kLeast) & (u <= kMost)) ? u : Four{})};
      }
      groups_[first / kGroup] = {low, high};
    }
  });
}

void DensityGrid::FindPlaces(exec::WorkerPool& pool) {
  Four low{kFarthest, kFarthest, kFarthest}, high = -low;
  for (const Group& group : groups_) {
    low = Min(low, group.low);
    high = Max(high, group.high);
  }
  if (low[0] > high[0]) low = high = Four{};

  // Corners at multiples of the side: what does not move keeps its weights.
  const float longest = std::max({high[0] - low[0], high[1] - low[1], high[2] - low[2]});
  side_ = std::max(static_cast<float>(settings_.cell), longest / (kMostCells - 2));
  for (int a = 0; a < 3; ++a) {
    low_[a] = side_ * std::floor(low[a] / side_);
    n_[a] = std::clamp(static_cast<int>((high[a] - low_[a]) / side_) + 2, 2, kMostCells + 2);
  }
  layer_ = (n_[0] * n_[1] + 3) / 4 * 4;

  cells_.resize(points_.size());
  ForPoints(pool, [this](size_t begin, size_t end) {
    const auto of = [](auto x, auto y, auto z, float last) {
      return Four{static_cast<float>(x), static_cast<float>(y), static_cast<float>(z), last};
    };
    const float scale = 1 / side_;
    // The last number, the mass, stays.
    const Four origin = of(low_[0], low_[1], low_[2], 0), scales = of(scale, scale, scale, 1);
    const Four last_cell = of(n_[0] - 2, n_[1] - 2, n_[2] - 2, 0), most = of(1, 1, 1, kHeaviest);
    const Four strides = of(1, n_[0], layer_, 0);  // All sums are whole numbers below 2^24.
    Point* const points = points_.data();
    int32_t* const cells = cells_.data();
    for (size_t p = begin; p < end; ++p) {
      const Four place = (points[p].place - origin) * scales;
      const Four cell = __builtin_convertvector(
          __builtin_convertvector(Min(Max(place, Four{}), last_cell), FourInts), Four);
      points[p].place = Min(Max(place - cell, Four{}), most);
      const Four steps = cell * strides;
      cells[p] = static_cast<int32_t>(steps[0] + steps[1] + steps[2]);
    }
  });
}

template <typename Finish>
void DensityGrid::Scatter(exec::WorkerPool& pool, const Finish& finish) {
  masses_.resize(static_cast<size_t>(layer_) * static_cast<size_t>(n_[2]));
  corners_.resize(masses_.size());
  // Each piece owns the corners of some layers, and goes through all points. Unlike elsewhere there
  // are as many as workers, as every one costs: a corner sums its points in their order anyway.
  const int slabs = std::clamp(static_cast<int>(points_.size()) / kPointsASlab, 1,
                               std::min(pool.workers(), n_[2]));
  pool.ParallelFor(n_[2], (n_[2] + slabs - 1) / slabs, [this, finish](int first, int last) {
    const int32_t row = n_[0], layer = layer_, begin = first * layer, end = last * layer;
    // Groups beyond these give nothing here. The quarters are for rounding: points are asked again.
    const float least = low_[2] + side_ * (static_cast<float>(first) - 1.25f);
    const float most = low_[2] + side_ * (static_cast<float>(last) + 0.25f);
    const Point* const points = points_.data();
    const int32_t* const cells = cells_.data();
    Corner* const corners = corners_.data();
    float* const masses = masses_.data();
    std::fill(corners + begin, corners + end, Corner{});
    std::fill(masses + begin, masses + end, 0.0f);
    for (size_t g = 0; g < groups_.size(); ++g) {
      if (groups_[g].low[2] > most || groups_[g].high[2] < least) continue;
      const size_t stop = std::min(points_.size(), (g + 1) * kGroup);
      for (size_t p = g * kGroup; p < stop; ++p) {
        const Four& momentum = points[p].momentum;
        const float x1 = points[p].place[0], x0 = 1 - x1, y1 = points[p].place[1], y0 = 1 - y1;
        const float z1 = points[p].place[2], z0 = 1 - z1, mass = points[p].place[3];
        const Four a0 = x0 * momentum, a1 = x1 * momentum;
        const Four a00 = y0 * a0, a10 = y0 * a1, a01 = y1 * a0, a11 = y1 * a1;
        const float m0 = x0 * mass, m1 = x1 * mass;
        const float m00 = y0 * m0, m10 = y0 * m1, m01 = y1 * m0, m11 = y1 * m1;
        const auto add = [&](int32_t c, float weight) {
          if (c < begin || c >= end) return;
          corners[c].values += weight * a00;
          corners[c + 1].values += weight * a10;
          corners[c + row].values += weight * a01;
          corners[c + row + 1].values += weight * a11;
          masses[c] += weight * m00;
          masses[c + 1] += weight * m10;
          masses[c + row] += weight * m01;
          masses[c + row + 1] += weight * m11;
        };
        add(cells[p], z0);
        add(cells[p] + layer, z1);
      }
    }
    for (int32_t c = begin; c < end; c += 4) {
      Four mass;
      std::memcpy(&mass, masses + c, sizeof(mass));
      if (!All(mass == 0)) finish(mass, corners + c);
    }
  });
}

void DensityGrid::Densities(const PointSpans& position, std::span<const float> mass,
                            exec::WorkerPool& pool, std::span<float> densities) {
  Read(position, mass, pool, [](size_t) { return Four{}; });
  FindPlaces(pool);
  Scatter(pool, [](const Four&, Corner*) {});
  const float volume = side_ * side_ * side_;
  ForPoints(pool, [&](size_t begin, size_t end) {
    for (size_t p = begin; p < end; ++p) {
      float most = 0;
      for (int k = 0; k < 8; ++k) {
        const int32_t corner = cells_[p] + (k >> 2) * layer_ + (k >> 1 & 1) * n_[0] + (k & 1);
        most = std::max(most, masses_[static_cast<size_t>(corner)]);
      }
      densities[p] = points_[p].place[3] > 0 ? most / volume : 0;
    }
  });
}

void DensityGrid::Push(const DensityPoints& points, double dt, exec::WorkerPool& pool,
                       const ImpulseSpans& impulses) {
  const VelocitySpans& u = points.velocity;
  Read(points.position, points.mass, pool, [u, rest = points.rest_density](size_t p) {
    return Four{u.x[p], u.y[p], u.z[p], rest[p]};
  });
  FindPlaces(pool);

  const auto speed_2 = static_cast<float>(settings_.pressure_speed * settings_.pressure_speed);
  const float volume = static_cast<float>(settings_.excess) * side_ * side_ * side_;
  Scatter(pool, [speed_2, volume](const Four& mass, Corner* corners) {
    // density / (excess rest density) is mass^2 / rest, where the rest density is a mean by mass.
    const Four rest = volume * Four{corners[0].values[3], corners[1].values[3],
                                    corners[2].values[3], corners[3].values[3]};
    const Four ratio = Min(mass * mass / rest, Four{} + 1e3f);
    const Four pressure = ((rest > 0) & (ratio > 1)) ? speed_2 * (ratio - 1) : Four{};
    const Four inverse = mass > kLeastAround ? 1 / mass : Four{};
    const auto set = [](float one_over_mass, float f, Corner& corner) {
      corner.values *= one_over_mass;
      corner.values[3] = f;
    };
    set(inverse[0], pressure[0], corners[0]);
    set(inverse[1], pressure[1], corners[1]);
    set(inverse[2], pressure[2], corners[2]);
    set(inverse[3], pressure[3], corners[3]);
  });
  Gather(dt, pool, impulses);
}

void DensityGrid::Gather(double dt, exec::WorkerPool& pool, const ImpulseSpans& impulses) const {
  const auto part = static_cast<float>(-std::expm1(-settings_.damping_rate * std::max(dt, 0.0)));
  const auto step = static_cast<float>(dt >= 1e-5 ? std::min(dt, 0.25) : 1e-5);
  const float courant = static_cast<float>(settings_.pressure_speed) * step / side_;
  const float factor = -static_cast<float>(rod::kTheta) * step / (1 + courant * courant) / side_;
  const float fastest = kLongestMove * side_ / step;
  ForPoints(pool, [this, impulses, part, factor, fastest](size_t begin, size_t end) {
    const Point* const points = points_.data();
    const int32_t* const cells = cells_.data();
    const Corner* const corners = corners_.data();
    const int row = n_[0], layer = layer_;
    float *const x = impulses.x.data(), *const y = impulses.y.data(), *const z = impulses.z.data();
    for (size_t p = begin; p < end; ++p) {
      const float fx = points[p].place[0], fy = points[p].place[1], fz = points[p].place[2];
      const float mass = points[p].place[3];
      const Corner* const c = corners + cells[p];

      // Differences along an axis are averaged along the others.
      const Four& c00 = c[0].values;
      const Four& c10 = c[1].values;
      const Four& c01 = c[row].values;
      const Four& c11 = c[row + 1].values;
      const Four z00 = c[layer].values - c00, z10 = c[layer + 1].values - c10;
      const Four z01 = c[layer + row].values - c01, z11 = c[layer + row + 1].values - c11;
      const Four a00 = c00 + fz * z00, a10 = c10 + fz * z10;
      const Four a01 = c01 + fz * z01, a11 = c11 + fz * z11;
      const Four y0 = a01 - a00, y1 = a11 - a10;
      const Four a0 = a00 + fy * y0, a1 = a10 + fy * y1;
      const Four dx = a1 - a0, dy = Lerp(y0, y1, fx);
      const Four dz = Lerp(Lerp(z00, z01, fy), Lerp(z10, z11, fy), fx);
      const Four mean = a0 + fx * dx;

      // (H16), as a velocity, and (H17).
      float vx = factor * dx[3], vy = factor * dy[3], vz = factor * dz[3];
      const float speed_2 = vx * vx + vy * vy + vz * vz;
      if (speed_2 > fastest * fastest) {
        const float cut = fastest / std::sqrt(speed_2);
        vx *= cut, vy *= cut, vz *= cut;
      }
      const Four damping = part * (mass * mean - points[p].momentum);
      x[p] = mass * vx + damping[0];
      y[p] = mass * vy + damping[1];
      z[p] = mass * vz + damping[2];
    }
  });
}

}  // namespace mane::contact
