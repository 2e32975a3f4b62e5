#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <vector>

#include "rod/chain.h"
#include "rod/statics.h"
#include "rod/step.h"
#include "rod/test_strands.h"

/// A moderate shake of the head, by which strands of different elements are compared.
namespace mane::rod::fixtures {

/// Pose of the head at time `t` [s]: up to 3 cm and half a radian about the vertical axis, near
/// 1 Hz, from standstill.
inline math::Pose ShakenHead(double t) {
  const double w = 2 * M_PI, e = std::min(1.0, t / 0.2);
  const Eigen::Vector3d p(0.03 * std::sin(1.3 * w * t), 0.01 * std::sin(1.9 * w * t),
                          0.02 * std::sin(0.9 * w * t));
  const Eigen::Vector3d turn(0.1 * std::sin(0.8 * w * t), 0.5 * std::sin(1.1 * w * t),
                             0.1 * std::sin(1.4 * w * t));
  return {e * p, math::FromRotationVector(e * turn)};
}

/// Roots on the side of a head, n0 from nearly straight down to steeply up, each rolled its own
/// way.
inline std::vector<math::Pose> SideRoots() {
  const double elevation[] = {0, 0.5, -0.8, 0.2, 0.9, -1.3}, roll[] = {0, 1, 2.5, 4, 5, 0.5};
  std::vector<math::Pose> roots;
  for (int i = 0; i < 6; ++i) {
    const Eigen::Quaterniond q =
        Eigen::Quaterniond(Eigen::AngleAxisd(elevation[i], Eigen::Vector3d::UnitZ())) *
        Eigen::AngleAxisd(roll[i], Eigen::Vector3d::UnitX());
    roots.push_back({{0.09, 0, 0}, q});
  }
  return roots;
}

/// At rest under gravity.
inline State AtRest(const Strand& strand, const math::Pose& root) {
  State state(strand);
  (void)SolveRestShape(strand, root, {0, -9.81, 0}, state.theta);
  return state;
}

inline Eigen::Vector3d TipOf(const Strand& strand, const math::Pose& clamp,
                             const std::vector<Eigen::Vector3d>& theta) {
  return ElementFrames(strand, clamp, theta).back().r;
}

/// Where the tip is, at 60 Hz, in two seconds of the shake from rest, by steps of 1/240 s. Empty if
/// a step failed.
inline std::vector<Eigen::Vector3d> ShakenTips(const Strand& strand, const math::Pose& root) {
  constexpr int kSteps = 480, kEvery = 4;
  constexpr double kDt = 1.0 / 240;
  State state = AtRest(strand, root);
  StepScratch scratch;
  std::vector<Eigen::Vector3d> tips;
  for (int i = 1; i <= kSteps; ++i) {
    const math::Pose begin = ShakenHead((i - 1) * kDt) * root, end = ShakenHead(i * kDt) * root;
    if (!Step(strand, {begin, end, kDt}, {}, state.View(), scratch)) return {};
    if (i % kEvery == 0) tips.push_back(TipOf(strand, end, state.theta));
  }
  return tips;
}

/// Rms distance of two equally long lists of points.
inline double RmsDistance(const std::vector<Eigen::Vector3d>& a,
                          const std::vector<Eigen::Vector3d>& b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += (a[i] - b.at(i)).squaredNorm();
  return std::sqrt(squares / static_cast<double>(a.size()));
}

}  // namespace mane::rod::fixtures
