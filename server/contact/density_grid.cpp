#include "contact/density_grid.h"

#include <algorithm>
#include <cmath>

#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Vector3f;

constexpr int kMostCells = 64;         // Along an axis.
constexpr float kFarthest = 1e4f;      // From the origin [m].
constexpr float kFastest = 1e3f;       // [m/s]
constexpr float kLongestMove = 0.25f;  // That pressure may cause in a step, by the cell's side.
constexpr int kPointsAPiece = 1024;

}  // namespace

template <typename Visit>
void DensityGrid::ForCorners(const Place& place, const Visit& visit) const {
  const Vector3f& f = place.fraction;
  for (int k = 0; k < 8; ++k) {
    const int i[3] = {k & 1, k >> 1 & 1, k >> 2};
    float w[3], slope[3];
    for (int a = 0; a < 3; ++a) {
      w[a] = i[a] == 1 ? f[a] : 1 - f[a];
      slope[a] = (i[a] == 1 ? 1 : -1) / side_;
    }
    const int node = place.node + (i[2] * n_[1] + i[1]) * n_[0] + i[0];
    visit(static_cast<size_t>(node), w[0] * w[1] * w[2],
          Vector3f(slope[0] * w[1] * w[2], w[0] * slope[1] * w[2], w[0] * w[1] * slope[2]));
  }
}

template <int width, typename Value>
void DensityGrid::Scatter(const Value& value, exec::WorkerPool& pool,
                          std::vector<float>& sums) const {
  const auto layer_size = static_cast<size_t>(n_[0]) * n_[1];
  sums.resize(layer_size * static_cast<size_t>(n_[2]) * width);
  // A layer of corners receives from the cells on either side of it, always in one order.
  pool.ParallelFor(n_[2], 1, [&](int layer, int) {
    const auto begin = static_cast<size_t>(layer) * layer_size * width;
    std::fill_n(sums.begin() + static_cast<ptrdiff_t>(begin), layer_size * width, 0.0f);
    for (int side = 1; side >= 0; --side) {
      const int cells = layer - side;
      if (cells < 0 || cells + 1 >= n_[2]) continue;
      const int32_t end = layer_start_[static_cast<size_t>(cells) + 1];
      for (int32_t i = layer_start_[static_cast<size_t>(cells)]; i < end; ++i) {
        const auto p = static_cast<size_t>(by_layer_[static_cast<size_t>(i)]);
        const Place& place = places_[p];
        const Vector3f& f = place.fraction;
        const Eigen::Matrix<float, width, 1> v = value(p);
        for (int k = 0; k < 4; ++k) {
          const int x = k & 1, y = k >> 1;
          const float weight =
              (x ? f[0] : 1 - f[0]) * (y ? f[1] : 1 - f[1]) * (side ? f[2] : 1 - f[2]);
          const auto node =
              static_cast<size_t>(place.node + (side * n_[1] + y) * n_[0] + x) * width;
          for (size_t j = 0; j < width; ++j) sums[node + j] += weight * v[static_cast<int>(j)];
        }
      }
    }
  });
}

void DensityGrid::Build(const PointSpans& position, std::span<const float> mass,
                        exec::WorkerPool& pool) {
  position_ = position;
  mass_ = mass;
  FindPlaces(pool);
  SortByLayer();
  Scatter<1>([&](size_t p) { return Eigen::Matrix<float, 1, 1>(mass_[p]); }, pool, node_mass_);
}

void DensityGrid::FindPlaces(exec::WorkerPool& pool) {
  const auto point = [&](size_t p) {
    return Vector3f(position_.x[p], position_.y[p], position_.z[p]);
  };
  const auto usable = [&](size_t p) {
    return Within(point(p), kFarthest) && mass_[p] >= 1e-12f && mass_[p] <= 1e6f;
  };
  Vector3f low = Vector3f::Constant(kFarthest), high = -low;
  for (size_t p = 0; p < mass_.size(); ++p) {
    if (!usable(p)) continue;
    low = low.cwiseMin(point(p));
    high = high.cwiseMax(point(p));
  }
  if (!(low.array() <= high.array()).all()) low = high = Vector3f::Zero();

  // Corners at multiples of the side: what does not move keeps its weights.
  side_ = std::max(static_cast<float>(settings_.cell), (high - low).maxCoeff() / (kMostCells - 2));
  low_ = side_ * (low / side_).array().floor();
  for (int a = 0; a < 3; ++a) {
    n_[a] = std::clamp(static_cast<int>((high[a] - low_[a]) / side_) + 2, 2, kMostCells + 2);
  }
  places_.resize(mass_.size());
  pool.ParallelFor(static_cast<int>(mass_.size()), kPointsAPiece, [&](int begin, int end) {
    for (auto p = static_cast<size_t>(begin); p < static_cast<size_t>(end); ++p) {
      Place& place = places_[p];
      place.node = -1;
      if (!usable(p)) continue;
      const Vector3f cells = (point(p) - low_) / side_;
      int i[3];
      for (int a = 0; a < 3; ++a) {
        i[a] = std::clamp(static_cast<int>(cells[a]), 0, n_[a] - 2);
        place.fraction[a] = std::clamp(cells[a] - static_cast<float>(i[a]), 0.0f, 1.0f);
      }
      place.layer = i[2];
      place.node = (i[2] * n_[1] + i[1]) * n_[0] + i[0];
    }
  });
}

void DensityGrid::SortByLayer() {
  layer_start_.assign(static_cast<size_t>(n_[2]) + 1, 0);
  for (const Place& place : places_) {
    if (place.node >= 0) ++layer_start_[static_cast<size_t>(place.layer)];
  }
  int32_t sum = 0;
  for (int32_t& k : layer_start_) k = sum += k;
  by_layer_.resize(static_cast<size_t>(sum));
  for (size_t p = places_.size(); p-- > 0;) {
    if (places_[p].node < 0) continue;
    const auto k = static_cast<size_t>(--layer_start_[static_cast<size_t>(places_[p].layer)]);
    by_layer_[k] = static_cast<int32_t>(p);
  }
}

void DensityGrid::Densities(exec::WorkerPool& pool, std::span<float> densities) const {
  const float volume = side_ * side_ * side_;
  pool.ParallelFor(static_cast<int>(mass_.size()), kPointsAPiece, [&](int begin, int end) {
    for (auto p = static_cast<size_t>(begin); p < static_cast<size_t>(end); ++p) {
      densities[p] = 0;
      if (places_[p].node < 0) continue;
      ForCorners(places_[p], [&](size_t node, float, const Vector3f&) {
        densities[p] = std::max(densities[p], node_mass_[node] / volume);
      });
    }
  });
}

void DensityGrid::AddPressure(std::span<const float> rest_densities, double dt,
                              exec::WorkerPool& pool, const ImpulseSpans& impulses) {
  dt = dt >= 1e-5 ? std::min(dt, 0.25) : 1e-5;
  Scatter<1>(
      [&](size_t p) {
        const float rest = rest_densities[p];
        return Eigen::Matrix<float, 1, 1>(rest > 0 && std::isfinite(rest) ? mass_[p] * rest : 0);
      },
      pool, node_rest_);

  // From here on node_rest_ holds f' of (H15) [m^2/s^2].
  const float volume = side_ * side_ * side_;
  const auto speed_2 = static_cast<float>(settings_.pressure_speed * settings_.pressure_speed);
  const auto excess = static_cast<float>(settings_.excess);
  pool.ParallelFor(nodes(), 4 * kPointsAPiece, [&](int begin, int end) {
    for (auto c = static_cast<size_t>(begin); c < static_cast<size_t>(end); ++c) {
      const float mass = node_mass_[c], rest = excess * node_rest_[c];
      // density / (excess rest density), where the rest density is a mean by mass.
      const float ratio = rest > 0 ? mass * mass / (volume * rest) : 0;
      node_rest_[c] = ratio > 1 ? speed_2 * (std::min(ratio, 1e3f) - 1) : 0;
    }
  });

  const auto step = static_cast<float>(dt);
  const float courant = std::sqrt(speed_2) * step / side_;
  const float impulse = static_cast<float>(rod::kTheta) * step / (1 + courant * courant);
  const float fastest = kLongestMove * side_ / step;
  pool.ParallelFor(static_cast<int>(mass_.size()), kPointsAPiece, [&](int begin, int end) {
    for (auto p = static_cast<size_t>(begin); p < static_cast<size_t>(end); ++p) {
      if (places_[p].node < 0) continue;
      Vector3f velocity = Vector3f::Zero();
      ForCorners(places_[p], [&](size_t node, float, const Vector3f& gradient) {
        velocity -= impulse * node_rest_[node] * gradient;
      });
      const float speed = velocity.norm();
      if (speed > fastest) velocity *= fastest / speed;
      impulses.x[p] += mass_[p] * velocity.x();
      impulses.y[p] += mass_[p] * velocity.y();
      impulses.z[p] += mass_[p] * velocity.z();
    }
  });
}

void DensityGrid::AddDamping(const VelocitySpans& velocity, double dt, exec::WorkerPool& pool,
                             const ImpulseSpans& impulses) {
  const auto of = [&](size_t p) {
    const Vector3f u = velocity[p];
    return Within(u, kFastest) ? u : Vector3f(Vector3f::Zero());
  };
  Scatter<3>([&](size_t p) { return Vector3f(mass_[p] * of(p)); }, pool, node_momentum_);

  const auto part = static_cast<float>(-std::expm1(-settings_.damping_rate * std::max(dt, 0.0)));
  pool.ParallelFor(static_cast<int>(mass_.size()), kPointsAPiece, [&](int begin, int end) {
    for (auto p = static_cast<size_t>(begin); p < static_cast<size_t>(end); ++p) {
      if (places_[p].node < 0) continue;
      Vector3f mean = Vector3f::Zero();
      ForCorners(places_[p], [&](size_t node, float weight, const Vector3f&) {
        if (!(weight > 0)) return;
        mean += weight / node_mass_[node] * Vector3f::Map(&node_momentum_[3 * node]);
      });
      const Vector3f change = part * mass_[p] * (mean - of(p));
      impulses.x[p] += change.x();
      impulses.y[p] += change.y();
      impulses.z[p] += change.z();
    }
  });
}

}  // namespace mane::contact
