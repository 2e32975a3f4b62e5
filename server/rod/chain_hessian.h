#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/strand.h"

namespace mane::rod {

/// Energy, gradient and Hessian of elastic energy plus weight at one shape of a chain of elements
/// of n unknowns each, with the Hessian in O(N) numbers (rod.md, Statics, Q1 to Q4): blocks H_QQ on
/// the diagonal and H_QP = U_Q V_P^T for P < Q, of rank two. Everything by closed forms, to
/// rounding. The metric D is the diagonal of the stiffness matrix. PotentialHessian (hessian.h)
/// evaluates it for plain strands, n = 3, WoundHessian (wound_hessian.h) for wound ones, n = 4.
///
/// An object is one thread's; it allocates while it grows to its longest strand.
template <int n>
class ChainHessian {
 public:
  using Vector = Eigen::Matrix<double, n, 1>;
  using Matrix = Eigen::Matrix<double, n, n>;

  [[nodiscard]] double energy() const { return energy_; }                       ///< [J]
  [[nodiscard]] std::span<const Vector> gradient() const { return gradient_; }  ///< [J], (N).
  /// Diagonal of the stiffness matrix [J], (N).
  [[nodiscard]] std::span<const Vector> metric() const { return metric_; }

  /// The Hessian written out, (nN x nN), for checks.
  [[nodiscard]] Eigen::MatrixXd Dense() const;

  /// Factorises H + shift D. O(N).
  /// @return whether that is positive definite; only then may Solve be called.
  [[nodiscard]] bool Factor(double shift);
  /// x = (H + shift D)^-1 b, (N). O(N); `b` and `x` may be the same.
  void Solve(std::span<const Vector> b, std::span<Vector> x) const;

  /// Lowest eigenvalue of H x = lambda D x, to about 1e-9 of 1 + |lambda|, by bisection and inverse
  /// iteration; where `mode` is not empty, (N), also its x, of largest component 1. Positive for a
  /// minimum; 1 without weight where the stiffness matrix is diagonal. Overwrites the
  /// factorisation.
  double LowestEigenvalue(std::span<Vector> mode);

 protected:
  /// Evaluates the chain tip to root.
  ///
  /// @param root  left frame of the first element. @param gravity  [m/s^2], in the same frame.
  /// @param ends  of the elements, as helix.h's ElementEnd (N).
  /// @param kind  Stiffness(Q), (n x n) [J]; Strain(Q), x - x^n; and
  ///              SecondDerivative(Q, w, u, v, a) by x of w.(u p + v c + E a), a fixed (Q2).
  template <class End, class Kind>
  void Assemble(const Strand& strand, const Eigen::Matrix3d& root, const Eigen::Vector3d& gravity,
                std::span<const End> ends, const Kind& kind);

  double energy_ = 0;

 private:
  using Matrixn2 = Eigen::Matrix<double, n, 2>;
  struct Element {
    Eigen::Matrix3d R;      // Left frame, world.
    Matrix H;               // Block (Q, Q).
    Matrixn2 U, V;          // Blocks (Q, P) = U_Q V_P^T.
    Matrix L;               // Cholesky factor of the pivot,
    Matrixn2 V_eliminated;  // and V less what earlier elements took.
  };

  std::vector<Element> elements_;
  std::vector<Vector> gradient_, metric_;
};

template <int n>
template <class End, class Kind>
void ChainHessian<n>::Assemble(const Strand& strand, const Eigen::Matrix3d& root,
                               const Eigen::Vector3d& gravity, std::span<const End> ends,
                               const Kind& kind) {
  using Eigen::Matrix3d;
  using Eigen::Vector3d;
  const int N = strand.elements();
  elements_.resize(N);
  gradient_.resize(N);
  metric_.resize(N);
  // Two world axes across gravity, e1 x e2 along it: |g| (e2 e1^T - e1 e2^T) is [g].
  const double g = gravity.norm();
  const Vector3d down = g > 0 ? Vector3d(gravity / g) : Vector3d::UnitX();
  int least;
  (void)down.cwiseAbs().minCoeff(&least);
  const Vector3d e1 = down.cross(Vector3d::Unit(least)).normalized(), e2 = down.cross(e1);

  Matrix3d left = root;
  for (int Q = 0; Q < N; ++Q) {
    elements_[Q].R = left;
    left = left * ends[Q].E;
  }
  energy_ = 0;
  double mass_beyond = 0;
  Vector3d moment = Vector3d::Zero();  // Mass times position beyond, from the right end, world.
  for (int Q = N - 1; Q >= 0; --Q) {
    Element& element = elements_[Q];
    const End& end = ends[Q];
    const Matrix3d& R = element.R;
    const double l = strand.length[Q], mass = strand.linear_density * l;
    const Vector3d w = R.transpose() * gravity;
    const Vector3d beyond = R.transpose() * moment;

    // The load matrix B_Q: what a uniform field does to the element's unknowns.
    const Eigen::Matrix<double, n, 3> B = l * mass * end.G.transpose() +
                                          l * mass_beyond * end.J.transpose() +
                                          end.T.transpose() * math::Cross(beyond);
    const Matrix K = kind.Stiffness(Q);
    const Vector strain = kind.Strain(Q), elastic = K * strain;
    metric_[Q] = K.diagonal();
    gradient_[Q] = elastic - B * w;
    energy_ += 0.5 * elastic.dot(strain) - l * w.dot(mass * end.c + mass_beyond * end.p);
    // What lies beyond is fixed in the right frame.
    element.H = K - kind.SecondDerivative(Q, w, l * mass_beyond, l * mass,
                                          Vector3d(end.E.transpose() * beyond));
    const Eigen::Matrix<double, n, 3> B_world = B * R.transpose();
    element.U << g * (B_world * e1), -g * (B_world * e2);
    const Eigen::Matrix<double, 3, n> W = R * end.T;
    element.V << W.transpose() * e2, W.transpose() * e1;

    moment += R * (l * mass_beyond * end.p + l * mass * end.c);
    mass_beyond += mass;
  }
}

extern template class ChainHessian<3>;
extern template class ChainHessian<4>;

}  // namespace mane::rod
