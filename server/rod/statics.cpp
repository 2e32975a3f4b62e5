#include "rod/statics.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "rod/hessian.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;

constexpr int kMaxIterations = 200;
constexpr double kTolerance = 1e-9;
// Curvature of the energy, relative to the elastic one, that counts as none.
constexpr double kFlat = 1e-6;
constexpr double kEscapeAngle = 0.1;  // rad

// A moment to measure the residual by.
double MomentScale(const Strand& strand, const Vector3d& gravity) {
  const double L = strand.TotalLength();
  double scale = 0.5 * strand.linear_density * gravity.norm() * L * L;
  for (const Vector3d& natural : strand.natural) {
    scale = std::max(scale, strand.stiffness.cwiseProduct(natural).cwiseAbs().maxCoeff());
  }
  return std::max(scale, strand.stiffness.minCoeff() / L);
}

double Largest(std::span<const Vector3d> v) {
  double largest = 0;
  for (const Vector3d& x : v) largest = std::max(largest, x.cwiseAbs().maxCoeff());
  return largest;
}

double SquaredNorm(std::span<const Vector3d> v) {
  double sum = 0;
  for (const Vector3d& x : v) sum += x.squaredNorm();
  return sum;
}

}  // namespace

double StaticsResidual(const Strand& strand, const Vector3d& gravity,
                       std::span<const Vector3d> gradient) {
  return Largest(gradient) / MomentScale(strand, gravity);
}

StaticsReport SolveRestShape(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                             std::span<Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  std::vector<Vector3d> trial(theta.begin(), theta.end()), step(N);
  PotentialHessian here, there;
  here.Linearize(strand, clamp, gravity, theta);
  double lambda = 1e-3;
  StaticsReport report;
  for (; report.iterations < kMaxIterations; ++report.iterations) {
    report.residual = StaticsResidual(strand, gravity, here.gradient());
    if (report.residual <= kTolerance) {
      report.converged = here.Factor(kFlat);
      if (report.converged) break;
      // At a saddle there is no slope to follow: off along the most negative curvature.
      (void)here.LowestEigenvalue(step);
      for (int Q = 0; Q < N; ++Q) theta[Q] += kEscapeAngle * step[Q];
      here.Linearize(strand, clamp, gravity, theta);
      continue;
    }
    // Levenberg's damping, raised until the step is a descent that the energy confirms. Where
    // rounding hides the energy's change, a smaller gradient confirms it.
    bool accepted = false;
    for (int attempt = 0; attempt < 40 && !accepted; ++attempt) {
      if (here.Factor(lambda)) {
        here.Solve(here.gradient(), step);
        for (int Q = 0; Q < N; ++Q) trial[Q] = theta[Q] - step[Q];
        there.Linearize(strand, clamp, gravity, trial);
        const double slack = 1e-13 * std::abs(here.energy());
        accepted = there.energy() < here.energy() - slack ||
                   (there.energy() <= here.energy() + slack &&
                    SquaredNorm(there.gradient()) < SquaredNorm(here.gradient()));
      }
      lambda = accepted ? std::max(lambda * 0.2, 1e-12) : std::max(lambda * 5, 1e-12);
    }
    if (!accepted) break;
    std::copy(trial.begin(), trial.end(), theta.begin());
    std::swap(here, there);
  }
  return report;
}

}  // namespace mane::rod
