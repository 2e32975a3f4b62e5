#include "styling/farthest_points.h"

#include <algorithm>
#include <limits>

namespace mane::styling {

std::vector<uint32_t> FarthestPointCells(std::span<const Eigen::Vector3f> points, int count,
                                         const base::Cancelled& cancelled) {
  std::vector<uint32_t> cells(points.size());
  std::vector<float> squared(points.size(), std::numeric_limits<float>::infinity());
  size_t next = 0;
  for (int cell = 0; cell < count && next < points.size(); ++cell) {
    if (base::IsCancelled(cancelled)) break;
    const Eigen::Vector3f& middle = points[next];
    for (size_t i = 0; i < points.size(); ++i) {
      const float here = (points[i] - middle).squaredNorm();
      if (here >= squared[i]) continue;
      squared[i] = here;
      cells[i] = static_cast<uint32_t>(cell);
    }
    const auto farthest = std::ranges::max_element(squared);
    if (*farthest == 0) break;
    next = static_cast<size_t>(farthest - squared.begin());
  }
  return cells;
}

}  // namespace mane::styling
