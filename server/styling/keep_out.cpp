#include "styling/keep_out.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <variant>

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr float kFarAway = 1e9F;
constexpr float kMeshError = 1e-3F;  // [m]; fields are far better near their surface.
constexpr double kNear = 1e-5;       // [m] to the surface, near enough.
constexpr int kSteps = 20;
constexpr int kTurns = 16;       // Each leaves a small part of the depth.
constexpr double kAbove = 1e-7;  // [m]; so far out that rounding does not lead back in.

}  // namespace

KeepOut::KeepOut(const Obstacles& obstacles) {
  for (const Obstacle& obstacle : obstacles) {
    placed_.push_back(
        {&obstacle.shape,
         obstacle.pose.Inverse(),
         std::holds_alternative<std::shared_ptr<const contact::MeshField>>(obstacle.shape),
         {}});
  }
}

void KeepOut::Follow(std::span<const Vector3f> master) {
  for (Placed& placed : placed_) {
    DistancesTo(placed, master);
    placed.margin = one_;
    if (!placed.mesh) continue;
    for (float& margin : placed.margin) margin = margin / 3 - kMeshError;
  }
}

bool KeepOut::Gather(int k, float reach) {
  near_.clear();
  for (size_t i = 0; i < placed_.size(); ++i) {
    if (placed_[i].margin[k] <= reach) near_.push_back(static_cast<int>(i));
  }
  return !near_.empty();
}

void KeepOut::DistancesTo(const Placed& placed, std::span<const Vector3f> points) {
  const size_t n = points.size();
  for (auto* list : {&x_, &y_, &z_, &one_, &nx_, &ny_, &nz_}) list->resize(n);
  const Eigen::Matrix3f R = placed.to_shape.q.toRotationMatrix().cast<float>();
  const Vector3f p = placed.to_shape.p.cast<float>();
  for (size_t i = 0; i < n; ++i) {
    const Vector3f local = R * points[i] + p;
    x_[i] = local.x();
    y_[i] = local.y();
    z_[i] = local.z();
  }
  contact::At(*placed.shape, {x_, y_, z_}, {one_, nx_, ny_, nz_});
}

void KeepOut::Distances(std::span<const Vector3f> points, std::vector<float>& distance) {
  distance.assign(points.size(), kFarAway);
  for (int near : near_) {
    DistancesTo(placed_[near], points);
    for (size_t i = 0; i < points.size(); ++i) distance[i] = std::min(distance[i], one_[i]);
  }
}

contact::Distance KeepOut::At(const Vector3d& point) const {
  contact::Distance nearest{kFarAway, Vector3d::UnitY()};
  for (int near : near_) {
    const Placed& placed = placed_[near];
    const contact::Distance at = contact::At(*placed.shape, placed.to_shape * point);
    if (at.distance < nearest.distance) {
      nearest = {at.distance, placed.to_shape.q.conjugate() * at.normal};
    }
  }
  return nearest;
}

float KeepOut::Shorten(const Vector3f& base, const Vector3f& d, float distance) const {
  const auto f = [&](float part) {  // Aims at the middle of what is near enough.
    return At((base + part * d).cast<double>()).distance - 0.5 * kNear;
  };
  // The secant through both sides of the surface, after Illinois: a side that stays for a second
  // time counts half, since along a line into a convex body the secant falls short for ever.
  float out = 0, in = 1;
  double f_out = f(0), f_in = static_cast<double>(distance) - 0.5 * kNear;
  if (f_out < 0) return 0;
  int side = 0;
  for (int i = 0; i < kSteps && f_out != f_in; ++i) {
    const float part = out + (in - out) * static_cast<float>(f_out / (f_out - f_in));
    const double f_part = f(part);
    if (std::abs(f_part) <= 0.5 * kNear) return part;
    if (f_part > 0) {
      out = part;
      f_out = f_part;
      if (side == 1) f_in *= 0.5;
      side = 1;
    } else {
      in = part;
      f_in = f_part;
      if (side == -1) f_out *= 0.5;
      side = -1;
    }
  }
  return out;
}

Vector3f KeepOut::TurnOut(const Vector3f& joint, const Vector3f& tip) const {
  const Vector3d q = joint.cast<double>();
  Vector3d p = tip.cast<double>();
  const double length = (p - q).norm();
  for (int i = 0; i < kTurns; ++i) {
    const contact::Distance at = At(p);
    if (at.distance >= 0) break;
    const Vector3d out = p + (kAbove - at.distance) * at.normal - q;
    if (out.squaredNorm() == 0) break;
    p = q + length * out.normalized();
  }
  const double rest = At(p).distance;
  if (rest >= 0) return p.cast<float>();
  const Vector3f d = (p - q).cast<float>();
  return joint + Shorten(joint, d, static_cast<float>(rest)) * d;
}

}  // namespace mane::styling
