#include "head/polyline.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"

namespace mane::head {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

// A length found to this part of itself is as good as float32 points are.
constexpr double kLengthTolerance = 1e-5;
constexpr int kMostTries = 24;

// Largest fraction u in [0, 1] at which a + u (b - a) is at `distance` from `center`, a being
// nearer and b not.
double Leave(const Vector3d& center, const Vector3d& a, const Vector3d& b, double distance) {
  const Vector3d edge = b - a, arm = a - center;
  const double square = edge.squaredNorm();
  if (square == 0) return 1;
  const double half = arm.dot(edge) / square,
               rest = (arm.squaredNorm() - distance * distance) / square;
  return std::clamp(-half + std::sqrt(std::max(0.0, half * half - rest)), 0.0, 1.0);
}

}  // namespace

double Stride(std::span<const Vector3f> curve, double stride, std::span<Vector3d> directions) {
  MANE_CHECK(curve.size() >= 2 && stride > 0);
  const Vector3d end = curve.back().cast<double>();
  Vector3d node = curve.front().cast<double>(), a = node;
  Vector3d last = (curve[1] - curve[0]).cast<double>().normalized();
  size_t next = 1;
  for (size_t i = 0; i < directions.size(); ++i) {
    while (next < curve.size() &&
           (curve[next].cast<double>() - node).squaredNorm() < stride * stride) {
      a = curve[next++].cast<double>();
    }
    if (next == curve.size()) {
      const Vector3d left = end - node;
      const double part = left.norm() / stride;
      if (part > kLengthTolerance) last = left.normalized();
      std::fill(directions.begin() + static_cast<std::ptrdiff_t>(i), directions.end(), last);
      return static_cast<double>(i) + part;
    }
    const Vector3d b = curve[next].cast<double>();
    const Vector3d reached = a + Leave(node, a, b, stride) * (b - a);
    last = directions[i] = (reached - node).normalized();
    node = a = reached;
  }
  return static_cast<double>(directions.size()) + (end - node).norm() / stride;
}

double StrideLength(std::span<const Vector3f> curve, double length, int strides) {
  thread_local std::vector<Vector3d> directions;
  directions.resize(strides);
  // So many strides too many of either length; of a line that is straight, none.
  double high = length / strides, above = Stride(curve, high, directions) - strides;
  if (above >= -kLengthTolerance * strides) return high;
  // The straight way bounds it from below, but for a curve that ends where it begins.
  double low =
      std::max((curve.back() - curve.front()).cast<double>().norm() / strides, 1e-3 * high);
  double below = Stride(curve, low, directions) - strides;
  for (int i = 0; i < kMostTries && high - low > kLengthTolerance * high; ++i) {
    // Where a line through both ends would have it, but well inside.
    const double guess = below > above ? below / (below - above) : 0.5;
    const double middle = low + std::clamp(guess, 0.05, 0.95) * (high - low);
    const double off = Stride(curve, middle, directions) - strides;
    if (std::abs(off) <= kLengthTolerance) return middle;
    (off > 0 ? low : high) = middle;
    (off > 0 ? below : above) = off;
  }
  return high;
}

}  // namespace mane::head
