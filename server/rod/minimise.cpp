#include "rod/minimise.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr int kMaxIterations = 200;
constexpr double kTolerance = 1e-9;
// Curvature of the energy, relative to the elastic one, that counts as none.
constexpr double kFlat = 1e-6;

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
  MatrixXd lifted = H;
  lifted.diagonal() += kFlat * D;
  if (Eigen::LLT<MatrixXd>(lifted).info() == Eigen::Success) return VectorXd::Zero(D.size());
  const VectorXd root = D.cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(root.asDiagonal() * H * root.asDiagonal());
  return root.asDiagonal() * modes.eigenvectors().col(0);
}

}  // namespace

StaticsReport Minimise(const Potential& potential, const VectorXd& metric, double scale,
                       VectorXd* unknowns) {
  VectorXd& x = *unknowns;
  double energy = potential.Energy(x), lambda = 1e-3;
  VectorXd g = potential.Gradient(x), step;
  StaticsReport report;
  for (; report.iterations < kMaxIterations; ++report.iterations) {
    report.residual = g.cwiseAbs().maxCoeff() / scale;
    const MatrixXd H = potential.Hessian(x);
    if (report.residual <= kTolerance) {
      step = EscapeDirection(H, metric);
      report.converged = step.isZero(0);
      if (report.converged) break;
      step *= 0.1 / std::max(step.cwiseAbs().maxCoeff(), 1e-300);  // 0.1 rad off the saddle.
      x += step;
      energy = potential.Energy(x);
      g = potential.Gradient(x);
      continue;
    }
    // Levenberg's damping, raised until the step is a descent that the energy confirms. Where
    // rounding hides the energy's change, a smaller gradient confirms it.
    bool accepted = false;
    for (int attempt = 0; attempt < 40 && !accepted; ++attempt) {
      if (DampedStep(H, metric, lambda, g, &step)) {
        const VectorXd trial = x + step;
        const double trial_energy = potential.Energy(trial);
        const VectorXd trial_g = potential.Gradient(trial);
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
  return report;
}

}  // namespace mane::rod
