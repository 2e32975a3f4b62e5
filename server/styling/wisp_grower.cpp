#include "styling/wisp_grower.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "styling/members.h"

namespace mane::styling {
namespace {

using Eigen::Vector3f;

constexpr uint64_t kSalt = 0x4d454d424552534d;  // Of this file's streams.

// (W15): y x, with x a random direction and y uniform in [0, min(L, most)], L the way from `o`
// along x to the sphere of `radius` about 0. One draw of 64 bits makes the three numbers.
Vector3f Noise(const Vector3f& o, float radius, float most, uint64_t bits) {
  constexpr uint64_t kMask = (1U << 21) - 1;
  const float z = (static_cast<float>(bits & kMask) + 0.5F) * 0x1p-20F - 1;
  const float phi =
      static_cast<float>((bits >> 21) & kMask) * static_cast<float>(2 * std::numbers::pi * 0x1p-21);
  const float part = static_cast<float>(bits >> 42) * 0x1p-22F;
  const float rho = std::sqrt(std::max(0.0F, 1 - z * z));
  const Vector3f x(rho * std::cos(phi), rho * std::sin(phi), z);
  const float along = o.dot(x);
  const float inside = std::max(0.0F, radius * radius - o.squaredNorm());
  const float L = std::max(0.0F, std::sqrt(along * along + inside) - along);
  return part * std::min(L, most) * x;
}

// Polyline length of the first `joints` segments, a fraction of one allowed.
double LengthUpTo(std::span<const Vector3f> points, double joints) {
  double length = 0;
  for (size_t k = 1; k < points.size() && static_cast<double>(k - 1) < joints; ++k) {
    length += std::min(1.0, joints - static_cast<double>(k - 1)) *
              static_cast<double>((points[k] - points[k - 1]).norm());
  }
  return length;
}

}  // namespace

WispGrower::WispGrower(const Masters& masters, const Obstacles& obstacles, const Quantile& length,
                       std::span<const double> radii, double fuzziness, uint64_t seed)
    : masters_(masters),
      length_(length),
      radii_(radii),
      fuzziness_(static_cast<float>(fuzziness)),
      seed_(seed ^ kSalt),
      keep_out_(obstacles) {}

float WispGrower::Radius(int k) const {
  return RadiusAt(radii_, own_joints_ > 0 ? k / own_joints_ : 1.0);
}

void WispGrower::Grow(int wisp, uint32_t first, std::span<const Vector3f> roots,
                      std::span<Vector3f> points, std::span<uint32_t> counts) {
  const uint32_t joint = masters_.first_joint[wisp];
  const uint32_t n = masters_.first_joint[wisp + 1] - joint;
  points_ = std::span(masters_.points).subspan(joint, n);
  frames_ = std::span(masters_.frames).subspan(joint, n);
  own_joints_ = static_cast<double>(masters_.length[wisp]) / masters_.segment_length;
  keep_out_.Follow(points_);

  Start(first, roots);
  for (const Strand& strand : strands_) {
    points[static_cast<size_t>(strand.number) * n] = strand.point;
  }
  for (int k = 1; k < joints() && !strands_.empty(); ++k) {
    Propose(k);
    if (keep_out_.Gather(k, Radius(k))) StayOutside(k);
    std::erase_if(strands_, [&](Strand& strand) {
      const auto number = static_cast<size_t>(strand.number);
      return Advance(k, strand, points.subspan(number * n, n), counts[number]);
    });
  }
}

void WispGrower::Start(uint32_t first, std::span<const Vector3f> roots) {
  const double length = LengthUpTo(points_, own_joints_);
  const Eigen::Matrix3f to_frame = frames_[0].conjugate().toRotationMatrix();
  strands_.clear();
  for (size_t i = 0; i < roots.size(); ++i) {
    const Vector3f d = to_frame * (roots[i] - points_[0]);
    math::RandomStream random(seed_, first + i);
    const double u = length_(random.Uniform());
    strands_.push_back({.d = d,
                        .point = roots[i],
                        .radius = std::max(Radius(0), d.norm()),
                        .target = u * length,
                        .number = static_cast<int>(i),
                        .random = random});
  }
}

void WispGrower::Propose(int k) {
  const float radius = Radius(k);
  const Eigen::Matrix3f frame = frames_[k].toRotationMatrix();
  for (Strand& strand : strands_) {
    // (W14); where a radius of 0 has gathered all strands in the master there is nothing to scale.
    strand.d *= strand.radius > 0 ? radius / strand.radius : 0;
    if (fuzziness_ > 0) {
      strand.d += Noise(strand.d, radius, fuzziness_ * radius, strand.random.Bits());
    }
    strand.radius = radius;
    strand.point = points_[k] + frame * strand.d;
  }
}

void WispGrower::StayOutside(int k) {
  proposed_.clear();
  for (const Strand& strand : strands_) proposed_.push_back(strand.point);
  keep_out_.Distances(proposed_, distance_);
  for (size_t i = 0; i < strands_.size(); ++i) {
    if (distance_[i] >= 0) continue;
    Strand& strand = strands_[i];
    const Vector3f d = strand.point - points_[k];
    const float part = keep_out_.Shorten(points_[k], d, distance_[i]);
    strand.d *= part;
    strand.point = points_[k] + part * d;
  }
}

bool WispGrower::Advance(int k, Strand& strand, std::span<Vector3f> own, uint32_t& count) {
  const float step = (strand.point - own[k - 1]).norm();
  const double length = strand.length + static_cast<double>(step);
  if (length >= strand.target || k + 1 == joints()) {
    count = Finish(k, strand, own);
    return true;
  }
  own[k] = strand.point;
  strand.length = length;
  strand.step = step;
  return false;
}

uint32_t WispGrower::Finish(int k, const Strand& strand, std::span<Vector3f> own) {
  const auto left = static_cast<float>(strand.target - strand.length);
  const auto along = [&](const Vector3f& d, float length) -> Vector3f {
    const float norm = d.norm();
    return norm > 0 ? Vector3f(length / norm * d) : frames_[k] * Vector3f(length, 0, 0);
  };
  int joint = k - 1;  // From which the last segment leads to the tip.
  float length = left;
  Vector3f tip = own[joint] + along(strand.point - own[joint], length);
  // A spline would loop in a last span that is far shorter than the one before.
  if (joint > 0 && left < 0.5F * strand.step) {
    --joint;
    length = strand.step + left;
    tip = own[joint] + along(tip - own[joint], length);
  }
  // Nothing to do where all is outside that lies so near to the master.
  if (keep_out_.Gather(joint, (own[joint] - points_[joint]).norm() + length)) {
    tip = keep_out_.TurnOut(own[joint], tip);
  }
  own[joint + 1] = tip;
  return static_cast<uint32_t>(joint) + 2;
}

}  // namespace mane::styling
