#include "groom/blue_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <queue>
#include <utility>

#include "base/check.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

// Cubic cells over points: finds what lies within one cell size.
class CellGrid {
 public:
  CellGrid(std::span<const Vector3d> points, double size) : points_(points), size_(size) {
    low_ = points[0];
    for (const Vector3d& p : points) low_ = low_.cwiseMin(p);
    entries_.reserve(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      entries_.emplace_back(CellOf(points[i]), static_cast<int>(i));
    }
    std::ranges::sort(entries_);
  }

  // Calls visit(j, distance) for every other point j nearer than the cell size, in a fixed order.
  template <typename Visit>
  void ForNeighbors(int i, const Visit& visit) const {
    const Cell cell = CellOf(points_[i]);
    for (int64_t x = cell[0] - 1; x <= cell[0] + 1; ++x) {
      for (int64_t y = cell[1] - 1; y <= cell[1] + 1; ++y) {
        // Cells that differ in z only are neighbours in the sorted list.
        const Cell last{x, y, cell[2] + 1};
        auto entry = std::ranges::lower_bound(entries_, Entry{{x, y, cell[2] - 1}, 0});
        for (; entry != entries_.end() && entry->first <= last; ++entry) {
          const int j = entry->second;
          const double distance = (points_[j] - points_[i]).norm();
          if (j != i && distance < size_) visit(j, distance);
        }
      }
    }
  }

 private:
  using Cell = std::array<int64_t, 3>;
  using Entry = std::pair<Cell, int>;

  [[nodiscard]] Cell CellOf(const Vector3d& p) const {
    const Vector3d c = ((p - low_) / size_).array().floor();
    return {static_cast<int64_t>(c.x()), static_cast<int64_t>(c.y()), static_cast<int64_t>(c.z())};
  }

  std::span<const Vector3d> points_;
  double size_;
  Vector3d low_;
  std::vector<Entry> entries_;  // Sorted by cell, then by point.
};

}  // namespace

double HexagonalDistance(double area, int n) {
  return 2 * std::sqrt(area / (2 * std::sqrt(3.0) * n));
}

std::vector<int> EliminateToBlueNoise(std::span<const Vector3d> points, int n, double area) {
  const int m = static_cast<int>(points.size());
  MANE_CHECK(n >= 1 && n <= m && area > 0);
  const double reach = HexagonalDistance(area, n);
  const double nearest = reach * 0.65 * (1 - std::pow(double(n) / m, 1.5));
  const auto weight_at = [&](double distance) {
    const double w = 1 - std::max(distance, nearest) / reach;
    const double w2 = w * w, w4 = w2 * w2;
    return w4 * w4;
  };

  const CellGrid grid(points, reach);
  std::vector<double> weight(m, 0);
  std::priority_queue<std::pair<double, int>> heaviest;
  for (int i = 0; i < m; ++i) {
    grid.ForNeighbors(i, [&](int, double distance) { weight[i] += weight_at(distance); });
    heaviest.emplace(weight[i], i);
  }

  // Weights only fall, so that an outdated entry stands too high: it is found here and put back.
  std::vector<bool> gone(m, false);
  for (int left = m; left > n;) {
    const auto [queued_weight, i] = heaviest.top();
    heaviest.pop();
    if (queued_weight != weight[i]) {
      heaviest.emplace(weight[i], i);
      continue;
    }
    gone[i] = true;
    --left;
    grid.ForNeighbors(i, [&](int j, double distance) {
      if (!gone[j]) weight[j] -= weight_at(distance);
    });
  }

  std::vector<int> kept;
  kept.reserve(n);
  for (int i = 0; i < m; ++i) {
    if (!gone[i]) kept.push_back(i);
  }
  return kept;
}

}  // namespace mane::groom
