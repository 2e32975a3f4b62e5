#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/strand.h"

/// Second derivative of elastic energy plus weight for a chain of elements of n unknowns each, as
/// LinearElement of step.h is for motion (rod.md, Statics). Internal to this folder.
namespace mane::rod {

/// One element under its own weight and that of all beyond it, which hangs on its right end as a
/// rigid body: what is needed of it does not change with the element's own unknowns.
template <int n>
struct LoadedElement {
  using Vector = Eigen::Matrix<double, n, 1>;
  using Matrix = Eigen::Matrix<double, n, n>;

  double l;                 // Length [m].
  double mass;              // Of the element,
  double mass_beyond;       // and of all beyond it [kg].
  Eigen::Vector3d gravity;  // In the element's left frame.
  Eigen::Vector3d center;  // Centre of mass of what is beyond, from the right end in its frame [m].

  // Generalized load of gravity `g` as a matrix on it: load = B g, both in the left frame.
  template <class End>
  [[nodiscard]] Eigen::Matrix<double, n, 3> Load(const End& end) const {
    return l * mass * end.G.transpose() +
           mass_beyond * (l * end.J.transpose() + end.T.transpose() * math::Cross(end.E * center));
  }
  // Second derivative of the weight by the element's own unknowns, by central differences of the
  // load: good to about 1e-9 of it.
  template <class Kind>
  [[nodiscard]] Matrix OwnHessian(const Kind& kind, int Q, const Vector& x) const {
    constexpr double kStep = 1e-5;  // rad
    Matrix H;
    for (int i = 0; i < n; ++i) {
      const Vector step = kStep * Vector::Unit(i);
      H.col(i) =
          (Load(kind.End(Q, x - step)) - Load(kind.End(Q, x + step))) * gravity / (2 * kStep);
    }
    return 0.5 * (H + H.transpose());
  }
};

/// Second derivative of the energy, (nN x nN). Turning all beyond element P by omega is, for an
/// element Q beyond it, turning gravity by -omega; so the block (Q, P) is -B_Q [g] W_P with the
/// load matrix B_Q and W_P = domega/dx_P (rod.md, Statics).
///
/// @param kind  End(Q, x) of an element as helix.h's ElementEnd, Stiffness(Q) its (n x n) K.
/// @param root  left frame of the first element.
template <int n, class Kind>
Eigen::MatrixXd ChainHessian(const Kind& kind, const Strand& strand, const Eigen::Matrix3d& root,
                             const Eigen::Vector3d& gravity,
                             std::span<const Eigen::Matrix<double, n, 1>> x) {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  const int N = strand.elements();
  std::vector<Matrix3d> R(N + 1);
  std::vector<Vector3d> r(N + 1);
  R[0] = root;
  r[0].setZero();
  for (int Q = 0; Q < N; ++Q) {
    const auto end = kind.End(Q, x[Q]);
    r[Q + 1] = r[Q] + strand.length[Q] * (R[Q] * end.p);
    R[Q + 1] = R[Q] * end.E;
  }

  Eigen::MatrixXd H(n * N, n * N);
  double mass_beyond = 0;
  Vector3d moment = Vector3d::Zero();  // Sum of mass times position beyond.
  std::vector<Eigen::Matrix<double, n, 3>> loads(N);
  std::vector<Eigen::Matrix<double, 3, n>> turns(N);
  for (int Q = N - 1; Q >= 0; --Q) {
    const double l = strand.length[Q], mass = strand.linear_density * l;
    const auto end = kind.End(Q, x[Q]);
    const Vector3d arm =
        mass_beyond > 0 ? Vector3d(moment / mass_beyond - r[Q + 1]) : Vector3d::Zero();
    const LoadedElement<n> element{l, mass, mass_beyond, R[Q].transpose() * gravity,
                                   R[Q + 1].transpose() * arm};
    loads[Q] = element.Load(end) * R[Q].transpose();
    turns[Q] = R[Q] * end.T;
    H.template block<n, n>(n * Q, n * Q) =
        element.OwnHessian(kind, Q, x[Q]) + Eigen::Matrix<double, n, n>(kind.Stiffness(Q));
    mass_beyond += mass;
    moment += mass * (r[Q] + l * (R[Q] * end.c));
  }
  const Matrix3d gx = math::Cross(gravity);
  for (int Q = 0; Q < N; ++Q) {
    const Eigen::Matrix<double, n, 3> load = -loads[Q] * gx;
    for (int P = 0; P < Q; ++P) {
      const Eigen::Matrix<double, n, n> block = load * turns[P];
      H.template block<n, n>(n * Q, n * P) = block;
      H.template block<n, n>(n * P, n * Q) = block.transpose();
    }
  }
  return H;
}

}  // namespace mane::rod
