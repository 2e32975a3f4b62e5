#include "rod/fit_cost.h"

#include <algorithm>
#include <cmath>

#include "math/rigid.h"
#include "math/stumpff.h"
#include "rod/helix.h"

namespace mane::rod {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Matrix73 = Eigen::Matrix<double, 7, 3>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

namespace {

constexpr double kSlide = 1e-2;      // Weight of residuals along the tangent.
constexpr double kTwistScale = 0.5;  // rad: typical twist of an element,
constexpr double kJumpScale = 1.0;   // rad: and jump of its angles from the last one's (F5).

}  // namespace

std::vector<FitCost::Placed> FitCost::Place(const Shape& shape,
                                            std::vector<Target>* targets) const {
  std::vector<Matrix3d> R(N() + 1);
  std::vector<Vector3d> r(N() + 1);
  R[0] = shape.R;
  r[0].setZero();
  for (int Q = 0; Q < N(); ++Q) {
    const ElementEnd end = EndOfElement(shape.theta[Q]);
    r[Q + 1] = r[Q] + shape.L * Part(Q) * (R[Q] * end.p);
    R[Q + 1] = R[Q] * end.E;
  }
  const auto at = [&](double u) {
    const auto after = std::upper_bound(fraction_.begin() + 1, fraction_.end() - 1, u);
    const int Q = static_cast<int>(after - fraction_.begin()) - 1;
    const Vector3d& th = shape.theta[Q];
    const double s = (u - fraction_[Q]) / Part(Q);
    const math::Stumpff C = math::StumpffC(s * s * th.squaredNorm());
    const Vector3d A(0, th.z(), -th.y()), B = th.cross(A), d0 = Vector3d::UnitX();
    return Placed{Q, s,
                  r[Q] + shape.L * Part(Q) * s * (R[Q] * (d0 + s * C[2] * A + s * s * C[3] * B)),
                  R[Q] * (d0 + s * C[1] * A + s * s * C[2] * B)};
  };
  std::vector<Placed> placed(targets->size());
  double last = 0;
  for (size_t i = 0; i < targets->size(); ++i) {
    Target& target = (*targets)[i];
    placed[i] = at(target.u);
    if (!sliding || i + 1 == targets->size()) continue;
    const double reach = 0.5 / N();
    for (int pass = 0; pass < 3; ++pass) {
      const double along = placed[i].t.dot(target.x - placed[i].r) / shape.L;
      target.u = std::clamp(target.u + std::clamp(along, -reach, reach), last, 1.0);
      placed[i] = at(target.u);
    }
    last = target.u;
  }
  return placed;
}

double FitCost::Value(const Shape& shape, const std::vector<Target>& targets,
                      const std::vector<Placed>& placed) const {
  double cost = 0;
  for (size_t i = 0; i < targets.size(); ++i) {
    cost += targets[i].weight * (placed[i].r - targets[i].x).squaredNorm();
  }
  double penalty = 0;
  for (int Q = 0; Q < N(); ++Q) {
    penalty += std::pow(shape.theta[Q].x() / kTwistScale, 2);
    if (Q == 0) continue;
    const double mean = 0.5 * (Part(Q) + Part(Q - 1)) / kJumpScale;
    penalty += (mean * (shape.theta[Q] / Part(Q) - shape.theta[Q - 1] / Part(Q - 1))).squaredNorm();
  }
  return cost + variance * penalty;
}

// All beyond an element
// moves with it as a rigid body, and with the length as a similar one: a twist of seven numbers, so
// that the sums over points beyond are one 7 x 7 matrix (F6).
void FitCost::Normal(const Shape& shape, const std::vector<Target>& targets,
                     const std::vector<Placed>& placed, MatrixXd* H, VectorXd* g) const {
  const int n = N();
  H->setZero(3 + 3 * n, 3 + 3 * n);
  g->setZero(3 + 3 * n);
  std::vector<Matrix73> S(n);  // Twist of all beyond, per rate.
  std::vector<Matrix3d> frame(n);
  Matrix3d R = shape.R;
  Vector3d r = Vector3d::Zero();
  for (int Q = 0; Q < n; ++Q) {
    const ElementEnd end = EndOfElement(shape.theta[Q]);
    const double l = shape.L * Part(Q);
    frame[Q] = R;
    r += l * (R * end.p);
    const Matrix3d turn = R * end.T;
    S[Q] << l * R * end.J + math::Cross(r) * turn, turn, Eigen::RowVector3d::Zero();
    R = R * end.E;
  }
  Matrix7 M = Matrix7::Zero();
  Vector7 b = Vector7::Zero();
  size_t i = placed.size();
  for (int Q = n - 1; Q >= 0; --Q) {
    Matrix73 F = M * S[Q];
    Matrix3d own = S[Q].transpose() * F;
    Vector3d slope = S[Q].transpose() * b;
    for (; i > 0 && placed[i - 1].element == Q; --i) {
      const Placed& point = placed[i - 1];
      const Target& target = targets[i - 1];
      Matrix3d W = target.weight * Matrix3d::Identity();
      if (sliding && i < placed.size()) {
        W -= target.weight * (1 - kSlide) * point.t * point.t.transpose();
      }
      Eigen::Matrix<double, 3, 7> C;
      C << Matrix3d::Identity(), -math::Cross(point.r), point.r;
      const Matrix3d J = shape.L * Part(Q) * frame[Q] * PointOnElement(shape.theta[Q], point.s).J;
      const Vector3d e = W * (point.r - target.x);
      const Eigen::Matrix<double, 3, 7> WC = W * C;
      own += J.transpose() * W * J;
      slope += J.transpose() * e;
      F += WC.transpose() * J;
      M += C.transpose() * WC;
      b += C.transpose() * e;
    }
    H->block<3, 3>(3 + 3 * Q, 3 + 3 * Q) = own;
    g->segment<3>(3 + 3 * Q) = slope;
    for (int P = 0; P < Q; ++P) {
      H->block<3, 3>(3 + 3 * Q, 3 + 3 * P) = F.transpose() * S[P];
    }
    H->block<3, 2>(3 + 3 * Q, 0) = F.middleRows<3>(3).transpose() * shape.R.rightCols<2>();
    H->block<3, 1>(3 + 3 * Q, 2) = F.row(6).transpose();
  }
  const Eigen::Matrix<double, 3, 2> turns = shape.R.rightCols<2>();
  H->topLeftCorner<2, 2>() = turns.transpose() * M.block<3, 3>(3, 3) * turns;
  H->block<1, 2>(2, 0) = M.block<1, 3>(6, 3) * turns;
  (*H)(2, 2) = M(6, 6);
  g->head<2>() = turns.transpose() * b.segment<3>(3);
  (*g)[2] = b[6];
  AddPenalty(shape, H, g);
}

void FitCost::AddPenalty(const Shape& shape, MatrixXd* H, VectorXd* g) const {
  for (int Q = 0; Q < N(); ++Q) {
    const double twist = variance / (kTwistScale * kTwistScale);
    (*H)(3 + 3 * Q, 3 + 3 * Q) += twist;
    (*g)[3 + 3 * Q] += twist * shape.theta[Q].x();
    if (Q == 0) continue;
    const double a = 1 / Part(Q - 1), c = 1 / Part(Q);
    const double jump = variance * std::pow(0.5 * (Part(Q) + Part(Q - 1)) / kJumpScale, 2);
    const Vector3d d = c * shape.theta[Q] - a * shape.theta[Q - 1];
    g->segment<3>(3 * Q) -= jump * a * d;
    g->segment<3>(3 + 3 * Q) += jump * c * d;
    for (int k = 0; k < 3; ++k) {
      (*H)(3 * Q + k, 3 * Q + k) += jump * a * a;
      (*H)(3 + 3 * Q + k, 3 + 3 * Q + k) += jump * c * c;
      (*H)(3 + 3 * Q + k, 3 * Q + k) -= jump * a * c;
    }
  }
}

}  // namespace mane::rod
