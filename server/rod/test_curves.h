#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <vector>

#include "math/rigid.h"
#include "rod/chain.h"
#include "rod/fit.h"
#include "rod/helix.h"
#include "rod/strand.h"

/// Curves and polylines that the tests of fits share.
namespace mane::rod::fixtures {

using Points = std::vector<Eigen::Vector3d>;

inline double Length(const Fit& fit) {
  return std::accumulate(fit.length.begin(), fit.length.end(), 0.0);
}

/// Points at equal steps of a strand.
inline Points Sample(const std::vector<double>& length, const math::Pose& root, const Points& theta,
                     int n) {
  Strand strand;
  strand.length = length;
  const std::vector<ElementFrame> frames = ElementFrames(strand, root, theta);
  Points points;
  for (int i = 0; i < n; ++i) {
    const auto [Q, u] = Locate(strand, strand.TotalLength() * i / (n - 1));
    points.push_back(frames[Q].r + length[Q] * (frames[Q].R * PointOnElement(theta[Q], u).p));
  }
  return points;
}
inline Points Sample(const Fit& fit, int n) { return Sample(fit.length, fit.root, fit.theta, n); }

/// A curve of a parameter from 0 to 1.
using Curve = std::function<Eigen::Vector3d(double)>;

inline Points Sample(const Curve& curve, int n) {
  Points points;
  for (int i = 0; i < n; ++i) points.push_back(curve(static_cast<double>(i) / (n - 1)));
  return points;
}

/// Largest distance of points of the fit from the curve, by brute force: good to 1 / 40000 of
/// the curve.
inline double Deviation(const Fit& fit, const Curve& curve) {
  const Points fine = Sample(curve, 20001);
  double worst = 0;
  for (const Eigen::Vector3d& x : Sample(fit, 101)) {
    double nearest = 1e300;
    for (const Eigen::Vector3d& y : fine) nearest = std::min(nearest, (x - y).squaredNorm());
    worst = std::max(worst, std::sqrt(nearest));
  }
  return worst;
}

/// Two turns of growing pitch; a plane elastica-like wave; a wave in space.
inline Eigen::Vector3d Coil(double t) {
  const double a = 4 * M_PI * (t + 0.3 * t * t);
  return {0.02 * std::cos(a), 0.02 * std::sin(a), 0.15 * t * (1 + 0.5 * t)};
}
inline Eigen::Vector3d PlaneWave(double t) { return {0.2 * t, 0.03 * std::sin(7 * t), 0}; }
inline Eigen::Vector3d SpaceWave(double t) {
  return {0.2 * t, 0.02 * std::sin(7 * t), 0.03 * t * t};
}

}  // namespace mane::rod::fixtures
