#include "head/polyline.h"

#include <algorithm>
#include <cmath>

#include "base/check.h"

namespace mane::head {

using Eigen::Vector3d;
using Eigen::Vector3f;

namespace {

// A length found to this part of itself is as good as float32 points are.
constexpr double kLengthTolerance = 1e-6;
// A curve's end is reached with so much of a stride left.
constexpr double kLeft = 0.1;
// Where strides leap, lengths about that one are tried, relative.
constexpr int kTries = 20;
constexpr double kTryStep = 0.01;

// Fraction u in [0, 1] at which a + u (b - a) is at `distance` from `center`: a being nearer and b
// not where it leaves, else the other way round.
double Cross(const Vector3d& center, const Vector3d& a, const Vector3d& b, double distance,
             bool leaves) {
  const Vector3d edge = b - a, arm = a - center;
  const double square = edge.squaredNorm();
  if (square == 0) return 1;
  const double half = arm.dot(edge) / square,
               rest = (arm.squaredNorm() - distance * distance) / square;
  const double root = std::sqrt(std::max(0.0, half * half - rest));
  return std::clamp(-half + (leaves ? root : -root), 0.0, 1.0);
}

// Walks along the curve in strides that end where it first is so far from where they began. Returns
// whether none of them led past its end; else `places` from there on are its end.
bool Walk(std::span<const Vector3f> curve, double stride, std::span<double> places) {
  const auto end = static_cast<double>(curve.size() - 1);
  Vector3d node = curve.front().cast<double>(), a = node;
  double from = 0;  // Place of a.
  size_t next = 1;
  for (size_t i = 0; i < places.size(); ++i) {
    while (next < curve.size() &&
           (curve[next].cast<double>() - node).squaredNorm() < stride * stride) {
      a = curve[next].cast<double>();
      from = static_cast<double>(next++);
    }
    if (next == curve.size()) {
      std::fill(places.begin() + static_cast<std::ptrdiff_t>(i), places.end(), end);
      return i + 1 == places.size() && (a - node).norm() >= (1 - kLengthTolerance) * stride;
    }
    const Vector3d b = curve[next].cast<double>();
    const double part = Cross(node, a, b, stride, true);
    node = a + part * (b - a);
    from = places[i] = std::min(from + part * (static_cast<double>(next) - from), end);
    a = node;
  }
  return true;
}

// The same, but that of all places a stride away each is the one next to where equal arcs would
// have it. Returns whether there always was one.
bool WalkEvenly(std::span<const Vector3f> curve, double stride, std::span<double> places) {
  const double arc = static_cast<double>(curve.size() - 1) / static_cast<double>(places.size());
  Vector3d node = curve.front().cast<double>();
  double place = 0;
  for (size_t i = 0; i < places.size(); ++i) {
    const double wanted = arc * static_cast<double>(i + 1);
    Vector3d a = node, best = node;
    double from = place, found = -1;
    bool inside = true;
    for (auto next = static_cast<size_t>(place) + 1; next < curve.size(); ++next) {
      const Vector3d b = curve[next].cast<double>();
      const bool is_inside = (b - node).squaredNorm() < stride * stride;
      if (is_inside != inside) {
        const double part = Cross(node, a, b, stride, inside);
        const double at = from + part * (static_cast<double>(next) - from);
        if (at > place && (found < 0 || std::abs(at - wanted) < std::abs(found - wanted))) {
          found = at;
          best = a + part * (b - a);
        }
        if (at >= wanted) break;
      }
      inside = is_inside;
      a = b;
      from = static_cast<double>(next);
    }
    if (found < 0) return false;
    places[i] = place = found;
    node = best;
  }
  return true;
}

Vector3d At(std::span<const Vector3f> curve, double place) {
  const auto i = std::min(static_cast<size_t>(place), curve.size() - 2);
  const double part = place - static_cast<double>(i);
  return (1 - part) * curve[i].cast<double>() + part * curve[i + 1].cast<double>();
}

}  // namespace

double Stride(std::span<const Vector3f> curve, double length, std::span<double> places) {
  MANE_CHECK(curve.size() >= 2 && length > 0 && !places.empty());
  const auto k = static_cast<double>(places.size());
  // A line that is straight.
  double high = length / k;
  if (Walk(curve, high, places)) return high;
  // The straight way from end to end bounds it from below, but for a curve that ends where it
  // begins. At `low` all places are on the curve, at `high` they are not.
  const Vector3d end = curve.back().cast<double>();
  double low = std::max((end - curve.front().cast<double>()).norm(), 1e-3 * length) / k;
  while (!Walk(curve, low, places)) low /= 2;
  while (high - low > kLengthTolerance * high) {
    const double middle = 0.5 * (low + high);
    (Walk(curve, middle, places) ? low : high) = middle;
  }
  Walk(curve, low, places);
  const auto left = [&] { return (end - At(curve, places.back())).norm(); };
  double best = low, least = left();
  if (least <= kLeft * low) return low;
  // There it leaps.
  bool even = false;
  for (int i = -kTries; i <= kTries; ++i) {
    const double stride = (1 + kTryStep * i) * low;
    if (stride > length / k || !WalkEvenly(curve, stride, places) || left() >= least) continue;
    best = stride, least = left(), even = true;
  }
  even ? WalkEvenly(curve, best, places) : Walk(curve, best, places);
  return best;
}

void Between(std::span<const Vector3f> curve, std::span<const double> places,
             std::span<Vector3d> directions) {
  Vector3d node = curve.front().cast<double>(), direction = Vector3d::UnitY();
  for (size_t i = 0; i < places.size(); ++i) {
    const Vector3d next = At(curve, places[i]);
    const double d = (next - node).norm();
    if (d > 0) direction = (next - node) / d;
    directions[i] = direction;
    node = next;
  }
}

}  // namespace mane::head
