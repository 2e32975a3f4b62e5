#include "rod/statics.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/check.h"
#include "rod/chain.h"
#include "rod/energy.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kMaxIterations = 200;
constexpr double kTolerance = 1e-9;
// Curvature of the energy, relative to the elastic one, that counts as none.
constexpr double kFlat = 1e-6;

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
  [[nodiscard]] MatrixXd Hessian(const VectorXd& x) const;
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

// One element under its own weight and that of all beyond it, which hangs on its right end as a
// rigid body: what is needed of it does not change with the element's own angles.
struct LoadedElement {
  double l;            // Length [m].
  double mass;         // Of the element,
  double mass_beyond;  // and of all beyond it [kg].
  Vector3d stiffness;  // (EI)_i / l
  Vector3d gravity;    // In the element's left frame.
  Vector3d center;     // Centre of mass of what is beyond, from the right end in its frame [m].

  // Generalized load of gravity `g` as a matrix on it: load = B g, both in the left frame.
  [[nodiscard]] Matrix3d Load(const ElementEnd& end) const {
    return l * mass * end.G.transpose() +
           mass_beyond * (l * end.J.transpose() + end.T.transpose() * math::Cross(end.E * center));
  }
  // Second derivative by the element's own angles, by central differences of the load: good to
  // about 1e-9 of it.
  [[nodiscard]] Matrix3d OwnHessian(const Vector3d& theta) const {
    constexpr double kStep = 1e-5;  // rad
    Matrix3d H;
    for (int i = 0; i < 3; ++i) {
      const Vector3d step = kStep * Vector3d::Unit(i);
      H.col(i) = (Load(EndOfElement(theta - step)) - Load(EndOfElement(theta + step))) * gravity /
                 (2 * kStep);
    }
    Matrix3d symmetric = 0.5 * (H + H.transpose());
    symmetric.diagonal() += stiffness;
    return symmetric;
  }
};

// Second derivative of the energy, (3N x 3N). Turning all beyond element P by omega is, for an
// element Q beyond it, turning gravity by -omega; so the block (Q, P) is -B_Q [g] W_P with the load
// matrix B_Q and W_P = domega/dtheta_P (rod.md, Statics).
MatrixXd Problem::Hessian(const VectorXd& x) const {
  const std::span<const Vector3d> theta = Angles(x);
  const int N = strand.elements();
  const std::vector<ElementFrame> frames = ElementFrames(strand, clamp, theta);
  const Matrix3d gx = math::Cross(gravity);
  MatrixXd H(3 * N, 3 * N);
  double mass_beyond = 0;
  Vector3d moment = Vector3d::Zero();  // Sum of mass times position beyond, world.
  std::vector<Matrix3d> loads(N), turns(N);
  for (int Q = N - 1; Q >= 0; --Q) {
    const Matrix3d& R = frames[Q].R;
    const double l = strand.length[Q], mass = strand.linear_density * l;
    const ElementEnd end = EndOfElement(theta[Q]);
    const Vector3d arm =
        mass_beyond > 0 ? Vector3d(moment / mass_beyond - frames[Q + 1].r) : Vector3d::Zero();
    const LoadedElement element{l,
                                mass,
                                mass_beyond,
                                strand.stiffness / l,
                                R.transpose() * gravity,
                                frames[Q + 1].R.transpose() * arm};
    loads[Q] = element.Load(end) * R.transpose();
    turns[Q] = R * end.T;
    H.block<3, 3>(3 * Q, 3 * Q) = element.OwnHessian(theta[Q]);
    mass_beyond += mass;
    moment += mass * (frames[Q].r + l * (R * end.c));
  }
  for (int Q = 0; Q < N; ++Q) {
    const Matrix3d load = -loads[Q] * gx;
    for (int P = 0; P < Q; ++P) {
      H.block<3, 3>(3 * Q, 3 * P) = load * turns[P];
      H.block<3, 3>(3 * P, 3 * Q) = H.block<3, 3>(3 * Q, 3 * P).transpose();
    }
  }
  return H;
}

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
