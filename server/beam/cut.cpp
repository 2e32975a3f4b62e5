#include "beam/cut.h"

#include <algorithm>
#include <cmath>

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Part of a segment below which it is left out: a speck of hair has no direction.
constexpr double kSpeck = 1e-3;

// Segments up to where `height`, linear in the point, falls below 0.
template <typename Height>
double UpTo(std::span<const Vector3f> nodes, const Height& height) {
  double before = 0;
  for (size_t i = 0; i < nodes.size(); ++i) {
    const double here = height(nodes[i].cast<double>());
    if (here < 0) return i == 0 ? 0 : static_cast<double>(i) - 1 + before / (before - here);
    before = here;
  }
  return static_cast<double>(nodes.size()) - 1;
}

double LengthAt(const Cut::ByPore& by_pore, double y) {
  const double share = (y - by_pore.low_y) / (by_pore.high_y - by_pore.low_y);
  return std::lerp(by_pore.low_length, by_pore.high_length, std::clamp(share, 0.0, 1.0));
}

}  // namespace

double KeptBy(const Cut& cut, std::span<const Vector3f> nodes, double segment_length) {
  double kept = static_cast<double>(nodes.size()) - 1;
  if (cut.height) {
    kept = std::min(kept, UpTo(nodes, [&](const Vector3d& p) { return p.y() - *cut.height; }));
  }
  for (const HalfSpace& half : cut.keep) {
    kept = std::min(kept, UpTo(nodes, [&](const Vector3d& p) { return half.HeightOf(p); }));
  }
  if (cut.by_pore) kept = std::min(kept, LengthAt(*cut.by_pore, nodes[0].y()) / segment_length);
  return kept;
}

int EndHair(double kept, const Hull& hull, std::span<Vector3f> nodes) {
  int whole = static_cast<int>(kept);
  const double part = kept - whole;
  if (part > kSpeck) {
    const Vector3d from = nodes[whole].cast<double>(), to = nodes[whole + 1].cast<double>();
    const Vector3f end = (from + part * (to - from)).cast<float>();
    // A segment between nodes outside may pass through the hull: its end is no place for one.
    if (hull.At(end.cast<double>()) >= 0) nodes[++whole] = end;
  }
  return whole > 0 ? whole + 1 : 0;
}

}  // namespace mane::beam
