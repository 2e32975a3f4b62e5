#include "rod/statics.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "rod/energy.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMaxIterations = 200;
constexpr double kTolerance = 1e-9;

// The energy of one strand over its 3N angles.
struct Problem {
  const Strand& strand;
  const math::Pose& clamp;
  const Vector3d& gravity;

  static std::span<const Vector3d> Angles(const VectorXd& x) {
    return {reinterpret_cast<const Vector3d*>(x.data()), static_cast<size_t>(x.size() / 3)};
  }
  [[nodiscard]] double Energy(const VectorXd& x) const {
    return ElasticEnergy(strand, Angles(x)) + GravityPotential(strand, clamp, gravity, Angles(x));
  }
  [[nodiscard]] VectorXd Gradient(const VectorXd& x) const {
    VectorXd g(x.size());
    PotentialGradient(strand, clamp, gravity, Angles(x),
                      {reinterpret_cast<Vector3d*>(g.data()), static_cast<size_t>(x.size() / 3)});
    return g;
  }
  // By central differences of the exact gradient: O(N^2), good to about 1e-9 of its norm.
  [[nodiscard]] MatrixXd Hessian(const VectorXd& x) const {
    constexpr double kStep = 1e-5;  // rad
    MatrixXd H(x.size(), x.size());
    VectorXd moved = x;
    for (int i = 0; i < x.size(); ++i) {
      moved[i] = x[i] + kStep;
      const VectorXd above = Gradient(moved);
      moved[i] = x[i] - kStep;
      H.col(i) = (above - Gradient(moved)) / (2 * kStep);
      moved[i] = x[i];
    }
    return 0.5 * (H + H.transpose());
  }
  // A moment to measure the residual by: the weight's largest, or the natural shape's.
  [[nodiscard]] double MomentScale() const {
    const double L = strand.TotalLength();
    double scale = 0.5 * strand.linear_density * gravity.norm() * L * L;
    for (const Vector3d& natural : strand.natural) {
      scale = std::max(scale, strand.stiffness.cwiseProduct(natural).cwiseAbs().maxCoeff());
    }
    return std::max(scale, strand.stiffness.minCoeff() / L);
  }
};

// Newton's step of H + lambda D, or nothing when that is not positive definite.
bool DampedStep(const MatrixXd& H, const VectorXd& D, double lambda, const VectorXd& g,
                VectorXd* step) {
  MatrixXd damped = H;
  damped.diagonal() += lambda * D;
  const Eigen::LLT<MatrixXd> factor(damped);
  if (factor.info() != Eigen::Success) return false;
  *step = -factor.solve(g);
  return step->allFinite();
}

// At a saddle (a straight strand that stands upright) there is no slope to follow: returns the
// direction of the most negative curvature, or zero at a minimum.
VectorXd EscapeDirection(const MatrixXd& H, const VectorXd& D) {
  const VectorXd root = D.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(root.asDiagonal() * H * root.asDiagonal());
  if (modes.eigenvalues()[0] > -1e-6) return VectorXd::Zero(D.size());
  return root.asDiagonal() * modes.eigenvectors().col(0);
}

}  // namespace

StaticsReport SolveRestShape(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                             std::span<Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  const Problem problem{strand, clamp, gravity};
  VectorXd x = Eigen::Map<const VectorXd>(theta[0].data(), 3 * N);
  VectorXd D(3 * N);  // The elastic stiffness: the metric of the trust region.
  for (int Q = 0; Q < N; ++Q) D.segment<3>(3 * Q) = strand.stiffness / strand.length[Q];

  const double scale = problem.MomentScale();
  double energy = problem.Energy(x), lambda = 1e-3;
  VectorXd g = problem.Gradient(x), step;
  StaticsReport report;
  for (; report.iterations < kMaxIterations; ++report.iterations) {
    report.residual = g.cwiseAbs().maxCoeff() / scale;
    const MatrixXd H = problem.Hessian(x);
    if (report.residual <= kTolerance) {
      step = EscapeDirection(H, D);
      report.converged = step.isZero(0);
      if (report.converged) break;
      step *= 0.1 / std::max(step.cwiseAbs().maxCoeff(), 1e-300);  // 0.1 rad off the saddle.
      x += step;
      energy = problem.Energy(x);
      g = problem.Gradient(x);
      continue;
    }
    // Levenberg's damping, raised until the step is a descent that the energy confirms. Where
    // rounding hides the energy's change, a smaller gradient confirms it.
    bool accepted = false;
    for (int attempt = 0; attempt < 40 && !accepted; ++attempt) {
      if (DampedStep(H, D, lambda, g, &step)) {
        const VectorXd trial = x + step;
        const double trial_energy = problem.Energy(trial);
        const VectorXd trial_g = problem.Gradient(trial);
        const double slack = 1e-13 * std::abs(energy);
        accepted = trial_energy < energy - slack ||
                   (trial_energy <= energy + slack && trial_g.norm() < g.norm());
        if (accepted) {
          x = trial;
          energy = trial_energy;
          g = trial_g;
        }
      }
      lambda = accepted ? std::max(lambda * 0.2, 1e-12) : std::max(lambda * 5, 1e-12);
    }
    if (!accepted) break;
  }
  Eigen::Map<VectorXd>(theta[0].data(), 3 * N) = x;
  return report;
}

}  // namespace mane::rod
