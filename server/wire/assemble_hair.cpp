#include "wire/assemble_hair.h"

#include <algorithm>

#include "base/check.h"

namespace mane::wire {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3f;

constexpr float kLeastLength = 1e-12f;  // [m]
constexpr float kLeastDirection = 1e-6f;

// P_k, k from -1 to n.
Vector3f PointAt(std::span<const Vector3f> points, long k) {
  const long n = std::ssize(points);
  if (k >= 0 && k < n) return points[k];
  const long end = k < 0 ? 0 : n - 1, inward = k < 0 ? 1 : -1;
  if (n == 2) return 2 * points[end] - points[end + inward];
  return 3 * (points[end] - points[end + inward]) + points[end + 2 * inward];
}

// m_k.
Vector3f TangentAt(std::span<const Vector3f> points, long k) {
  return (PointAt(points, k + 1) - PointAt(points, k - 1)) / 2;
}

// Where a part of the arc length is among the points: x = j + u. Exact but for u's division.
struct Station {
  long j;
  float u;

  Station(uint16_t part, long n) {
    const long x = part * (n - 1);
    j = std::min(x / kTipPart, n - 2);
    u = static_cast<float>(x - j * kTipPart) / kTipPart;
  }
};

// p(s), as cubic Hermite interpolation.
Vector3f SplineAt(std::span<const Vector3f> points, const Station& at) {
  const Vector3f& a = points[at.j];
  const Vector3f chord = points[at.j + 1] - a;
  const Vector3f m0 = TangentAt(points, at.j), m1 = TangentAt(points, at.j + 1);
  const float u = at.u;
  return a + u * (m0 + u * ((3 * chord - 2 * m0 - m1) + u * (m0 + m1 - 2 * chord)));
}

// F(s). Neighbouring quaternions are at most a right angle apart: the mean is at least 0.7 long.
Quaternionf FrameAt(std::span<const Quaternionf> frames, const Station& at) {
  const Eigen::Vector4f mixed =
      (1 - at.u) * frames[at.j].coeffs() + at.u * frames[at.j + 1].coeffs();
  return Quaternionf(mixed.normalized());
}

}  // namespace

void CarryFrames(const Quaternionf& root, std::span<const Vector3f> points,
                 std::span<Quaternionf> frames) {
  MANE_CHECK(points.size() >= 2 && frames.size() == points.size());
  frames[0] = root;
  Vector3f before = root * Vector3f::UnitX();
  for (size_t k = 1; k < points.size(); ++k) {
    frames[k] = frames[k - 1];
    const Vector3f chord = points[k] - points[k - 1];
    const Vector3f tangent = TangentAt(points, static_cast<long>(k));
    if (!(chord.norm() >= kLeastLength && tangent.norm() >= kLeastLength)) continue;
    const Vector3f now = tangent.normalized(), a = chord.normalized();
    const Vector3f v = now - before + 2 * a.dot(before) * a;
    if (!(v.norm() >= kLeastDirection)) continue;
    const Vector3f b = v.normalized();
    Quaternionf turn;
    turn.w() = a.dot(b);
    turn.vec() = a.cross(b);
    if (turn.w() < 0) turn.coeffs() *= -1;  // So that neighbours are on one side, for (A3).
    frames[k] = (turn * frames[k - 1]).normalized();
    before = now;
  }
}

void AssembleHair(const CarriedGuide& guide, std::span<const HairPlace> places, float unit,
                  std::span<Vector3f> out) {
  const long n = std::ssize(guide.points);
  MANE_CHECK(n >= 2 && guide.frames.size() == guide.points.size() && out.size() == places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    const HairPlace& place = places[i];
    const Station at(place.part, n);
    const Vector3f offset =
        unit * Eigen::Map<const Eigen::Vector3<int16_t>>(place.offset.data()).cast<float>();
    out[i] = SplineAt(guide.points, at) + FrameAt(guide.frames, at) * offset;
  }
}

Vector3f OffsetOf(const CarriedGuide& guide, uint16_t part, const Vector3f& point) {
  const Station at(part, std::ssize(guide.points));
  return FrameAt(guide.frames, at).conjugate() * (point - SplineAt(guide.points, at));
}

}  // namespace mane::wire
