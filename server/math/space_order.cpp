#include "math/space_order.h"

#include <algorithm>

namespace mane::math {
namespace {

using Eigen::Array3d;
using Eigen::Vector3d;

constexpr int kBits = 16;  // Of a coordinate.

// The lowest kBits bits with two zeros before each.
uint64_t Spread(uint64_t x) {
  uint64_t spread = 0;
  for (int i = 0; i < kBits; ++i) spread |= (x >> i & 1) << (3 * i);
  return spread;
}

}  // namespace

std::vector<uint64_t> SpaceOrder(std::span<const Vector3d> points) {
  Array3d low = Array3d::Constant(1e300), high = -low;
  for (const Vector3d& p : points) {
    if (!p.allFinite()) continue;
    low = low.min(p.array());
    high = high.max(p.array());
  }
  const double side = std::max((high - low).maxCoeff(), 1e-300);
  constexpr double kCells = 1 << kBits;
  std::vector<uint64_t> keys;
  keys.reserve(points.size());
  for (const Vector3d& p : points) {
    uint64_t key = 0;
    for (int a = 0; p.allFinite() && a < 3; ++a) {
      const double part = (p[a] - low[a]) / side;
      const double cell = part < 1 ? kCells * part : kCells - 1;
      key |= Spread(static_cast<uint64_t>(cell)) << a;
    }
    keys.push_back(key);
  }
  return keys;
}

}  // namespace mane::math
