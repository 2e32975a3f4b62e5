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
constexpr int kBisections = 12;
constexpr int kTurns = 16;       // Each leaves a small part of the depth.
constexpr double kAbove = 1e-7;  // [m]; so far out that rounding does not lead back in.

}  // namespace

KeepOut::KeepOut(const Obstacles& obstacles) : obstacles_(obstacles) {}

void KeepOut::DistancesTo(const Obstacle& obstacle, std::span<const Vector3f> points) {
  const size_t n = points.size();
  for (auto* list : {&x_, &y_, &z_, &one_, &nx_, &ny_, &nz_}) list->resize(n);
  const math::Pose inverse = obstacle.pose.Inverse();
  const Eigen::Matrix3f R = inverse.q.toRotationMatrix().cast<float>();
  const Vector3f p = inverse.p.cast<float>();
  for (size_t i = 0; i < n; ++i) {
    const Vector3f local = R * points[i] + p;
    x_[i] = local.x();
    y_[i] = local.y();
    z_[i] = local.z();
  }
  contact::At(obstacle.shape, {x_, y_, z_}, {one_, nx_, ny_, nz_});
}

void KeepOut::Distances(std::span<const Vector3f> points, std::vector<float>& distance) {
  distance.assign(points.size(), kFarAway);
  for (const Obstacle& obstacle : obstacles_) {
    DistancesTo(obstacle, points);
    for (size_t i = 0; i < points.size(); ++i) distance[i] = std::min(distance[i], one_[i]);
  }
}

void KeepOut::Margins(std::span<const Vector3f> points, std::vector<float>& margin) {
  margin.assign(points.size(), kFarAway);
  for (const Obstacle& obstacle : obstacles_) {
    DistancesTo(obstacle, points);
    const bool mesh =
        std::holds_alternative<std::shared_ptr<const contact::MeshField>>(obstacle.shape);
    for (size_t i = 0; i < points.size(); ++i)
      margin[i] = std::min(margin[i], mesh ? one_[i] / 3 - kMeshError : one_[i]);
  }
}

float KeepOut::Shorten(const Vector3f& base, const Vector3f& d) const {
  float out = 0, in = 1;
  for (int i = 0; i < kBisections; ++i) {
    const float half = 0.5F * (out + in);
    const Vector3f point = base + half * d;
    (DistanceTo(obstacles_, point.cast<double>()).distance >= 0 ? out : in) = half;
  }
  return out;
}

Vector3f KeepOut::TurnOut(const Vector3f& joint, const Vector3f& tip) const {
  const Vector3d q = joint.cast<double>();
  Vector3d p = tip.cast<double>();
  const double length = (p - q).norm();
  for (int i = 0; i < kTurns; ++i) {
    const contact::Distance at = DistanceTo(obstacles_, p);
    if (at.distance >= 0) break;
    const Vector3d out = p + (kAbove - at.distance) * at.normal - q;
    if (out.squaredNorm() == 0) break;
    p = q + length * out.normalized();
  }
  return p.cast<float>();
}

}  // namespace mane::styling
