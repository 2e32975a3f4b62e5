#include "rod/chain.h"

#include <algorithm>

#include "base/check.h"
#include "math/quadrature.h"
#include "rod/scheme.h"

namespace mane::rod {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;

std::vector<ElementFrame> ElementFrames(const Strand& strand, const math::Pose& clamp,
                                        std::span<const Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  std::vector<ElementFrame> frames(N + 1);
  frames[0] = {clamp.q.toRotationMatrix(), clamp.p};
  for (int Q = 0; Q < N; ++Q) {
    const ElementEnd end = EndOfElement(theta[Q]);
    frames[Q + 1].r = frames[Q].r + strand.length[Q] * (frames[Q].R * end.p);
    frames[Q + 1].R = frames[Q].R * end.E;
  }
  return frames;
}

void GaussVelocities(std::span<const double> length, const math::Pose& clamp,
                     const Vector3d& velocity, const Vector3d& spin,
                     std::span<const Vector3d> theta, std::span<const Vector3d> rate,
                     std::span<Vector3d> result) {
  const size_t N = length.size();
  MANE_CHECK(theta.size() == N && rate.size() == N && result.size() == N * kGaussPoints);
  Matrix3d R = clamp.q.toRotationMatrix();
  Vector3d rdot = velocity, omega = spin;  // Of the left end (H9).
  for (size_t Q = 0; Q < N; ++Q) {
    const double l = length[Q];
    for (int g = 0; g < kGaussPoints; ++g) {
      const ElementPoint point = PointOnElement(theta[Q], kGauss.nodes[g]);
      result[Q * kGaussPoints + g] =
          rdot + omega.cross(l * (R * point.p)) + l * (R * (point.J * rate[Q]));
    }
    const ElementEnd end = EndOfElement(theta[Q]);
    rdot += omega.cross(l * (R * end.p)) + l * (R * (end.J * rate[Q]));
    omega += R * (end.T * rate[Q]);
    R = R * end.E;
  }
}

ArcPosition Locate(const Strand& strand, double s) {
  const int N = strand.elements();
  for (int Q = 0; Q < N; ++Q) {
    if (s <= strand.length[Q] || Q == N - 1) {
      return {Q, std::clamp(s / strand.length[Q], 0.0, 1.0)};
    }
    s -= strand.length[Q];
  }
  return {0, 0};
}

PointKinematics PointAt(const Strand& strand, const math::Pose& clamp,
                        std::span<const Vector3d> theta, ArcPosition where) {
  const std::vector<ElementFrame> frames = ElementFrames(strand, clamp, theta);
  const int P = where.element;
  const ElementPoint own = PointOnElement(theta[P], where.fraction);
  const double l = strand.length[P];
  PointKinematics point{frames[P].r + l * (frames[P].R * own.p),
                        MatrixXd::Zero(3, 3 * strand.elements())};
  point.J.middleCols<3>(3 * P) = l * frames[P].R * own.J;
  // An earlier element moves the rest of the strand rigidly with its right end.
  for (int Q = 0; Q < P; ++Q) {
    const ElementEnd end = EndOfElement(theta[Q]);
    const Matrix3d& R = frames[Q].R;
    const Vector3d arm = point.r - frames[Q + 1].r;
    point.J.middleCols<3>(3 * Q) = strand.length[Q] * R * end.J - math::Cross(arm) * R * end.T;
  }
  return point;
}

MatrixXd MassMatrix(const Strand& strand, const math::Pose& clamp, std::span<const Vector3d> theta,
                    int points) {
  const int N = strand.elements();
  const math::Quadrature rule = math::GaussLegendre(points);
  MatrixXd M = MatrixXd::Zero(3 * N, 3 * N);
  for (int Q = 0; Q < N; ++Q) {
    for (int g = 0; g < points; ++g) {
      const MatrixXd J = PointAt(strand, clamp, theta, {Q, rule.nodes[g]}).J;
      M += strand.linear_density * strand.length[Q] * rule.weights[g] * J.transpose() * J;
    }
  }
  return M;
}

}  // namespace mane::rod
