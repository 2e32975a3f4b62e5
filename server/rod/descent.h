#pragma once

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <span>
#include <utility>
#include <vector>

#include "rod/statics.h"
#include "rod/strand.h"

/// The search for equilibrium (rod.md, Statics), of plain and of wound strands. Internal to this
/// folder.
namespace mane::rod::descent {

inline constexpr int kMaxIterations = 200;
inline constexpr double kTolerance = 1e-9;
/// Where no step is accepted at a residual below this, rounding is the reason.
inline constexpr double kNearlyFlat = 1e-4;
/// Curvature of the energy, relative to the elastic one, that counts as none.
inline constexpr double kFlat = 1e-6;
inline constexpr double kEscapeAngle = 0.1;  // rad

/// A moment [N m] to measure the residual by.
inline double MomentScale(const Strand& strand, const Eigen::Vector3d& gravity) {
  const double L = strand.TotalLength();
  double scale = 0.5 * strand.linear_density * gravity.norm() * L * L;
  for (const Eigen::Vector3d& natural : strand.natural) {
    scale = std::max(scale, strand.stiffness.cwiseProduct(natural).cwiseAbs().maxCoeff());
  }
  return std::max(scale, strand.stiffness.minCoeff() / L);
}

template <class V>
double Largest(std::span<const V> vectors) {
  double largest = 0;
  for (const V& v : vectors) largest = std::max(largest, v.cwiseAbs().maxCoeff());
  return largest;
}

/// StaticsResidual() of statics.h and wound_statics.h.
template <class V>
double Residual(const Strand& strand, const Eigen::Vector3d& gravity, std::span<const V> gradient) {
  return Largest(gradient) / MomentScale(strand, gravity);
}

template <class V>
double SquaredNorm(std::span<const V> vectors) {
  double sum = 0;
  for (const V& v : vectors) sum += v.squaredNorm();
  return sum;
}

/// At a saddle there is no slope to follow: off along the most negative curvature.
template <class Hessian>
void Escape(Hessian& here, std::span<typename Hessian::Vector> x,
            std::span<typename Hessian::Vector> step) {
  (void)here.LowestEigenvalue(step);
  for (size_t Q = 0; Q < x.size(); ++Q) x[Q] += kEscapeAngle * step[Q];
}

/// Newton's method with Levenberg's damping down to a local minimum of the energy.
///
/// @tparam Hessian    a ChainHessian<n>.
/// @param strand, gravity  what the residual is relative to.
/// @param linearize   (Hessian&, unknowns): evaluates the energy there.
/// @param x           in: where to start; out: the minimum [rad], (N).
template <class Hessian, class Linearize>
StaticsReport Descend(const Strand& strand, const Eigen::Vector3d& gravity,
                      const Linearize& linearize, std::span<typename Hessian::Vector> x) {
  using Vector = typename Hessian::Vector;
  const size_t N = x.size();
  const double scale = MomentScale(strand, gravity);
  std::vector<Vector> trial(x.begin(), x.end()), step(N);
  Hessian here, there;
  linearize(here, x);
  double lambda = 1e-3;
  StaticsReport report;
  for (; report.iterations < kMaxIterations; ++report.iterations) {
    report.residual = Largest(here.gradient()) / scale;
    if (report.residual <= kTolerance) {
      report.converged = here.Factor(kFlat);
      if (report.converged) break;
      Escape(here, x, step);
      linearize(here, x);
      continue;
    }
    // Levenberg's damping, raised until the step is a descent that the energy confirms. Where
    // rounding hides the energy's change, a smaller gradient confirms it.
    bool accepted = false;
    for (int attempt = 0; attempt < 40 && !accepted; ++attempt) {
      if (here.Factor(lambda)) {
        here.Solve(here.gradient(), step);
        for (size_t Q = 0; Q < N; ++Q) trial[Q] = x[Q] - step[Q];
        linearize(there, trial);
        const double slack = 1e-13 * std::abs(here.energy());
        accepted = there.energy() < here.energy() - slack ||
                   (there.energy() <= here.energy() + slack &&
                    SquaredNorm(there.gradient()) < SquaredNorm(here.gradient()));
      }
      lambda = accepted ? std::max(lambda * 0.2, 1e-12) : std::max(lambda * 5, 1e-12);
    }
    if (!accepted) {
      // Rounding may end the descent just above the tolerance, next to a saddle all the same.
      if (report.residual > kNearlyFlat || here.Factor(kFlat)) break;
      Escape(here, x, step);
      linearize(here, x);
      lambda = 1e-3;
      continue;
    }
    std::copy(trial.begin(), trial.end(), x.begin());
    std::swap(here, there);
  }
  return report;
}

}  // namespace mane::rod::descent
