#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "math/rigid.h"
#include "math/stumpff.h"
#include "rod/helix.h"
#include "rod/strand.h"

namespace mane::rod {

/// Energy, gradient and Hessian of ElasticEnergy + GravityPotential at one shape, with the Hessian
/// in O(N) numbers (rod.md, Statics, Q1 to Q4): blocks H_QQ on the diagonal and H_QP = U_Q V_P^T
/// for P < Q, of rank two. Everything by closed forms, to rounding. The metric D is the diagonal of
/// the stiffness matrix, (EI)_i / l.
///
/// An object is one thread's; it allocates while it grows to its longest strand.
class PotentialHessian {
 public:
  /// Evaluates at `theta` [rad], (N). O(N).
  ///
  /// @param gravity  [m/s^2], in the frame of `clamp`'s parent; only the clamp's rotation matters.
  void Linearize(const Strand& strand, const math::Pose& clamp, const Eigen::Vector3d& gravity,
                 std::span<const Eigen::Vector3d> theta);

  [[nodiscard]] double energy() const { return energy_; }                                ///< [J]
  [[nodiscard]] std::span<const Eigen::Vector3d> gradient() const { return gradient_; }  ///< [J]
  /// (EI)_i / l [J], (N).
  [[nodiscard]] std::span<const Eigen::Vector3d> metric() const { return metric_; }

  /// The Hessian written out, (3N x 3N), for checks.
  [[nodiscard]] Eigen::MatrixXd Dense() const;

  /// Factorises H + shift D. O(N).
  /// @return whether that is positive definite; only then may Solve be called.
  [[nodiscard]] bool Factor(double shift);
  /// x = (H + shift D)^-1 b, (N). O(N); `b` and `x` may be the same.
  void Solve(std::span<const Eigen::Vector3d> b, std::span<Eigen::Vector3d> x) const;

  /// Lowest eigenvalue of H x = lambda D x, to about 1e-9 of 1 + |lambda|, by bisection and inverse
  /// iteration; where `mode` is not empty, (N), also its x, of largest component 1. Without weight
  /// it is 1; positive for a minimum. Overwrites the factorisation.
  double LowestEigenvalue(std::span<Eigen::Vector3d> mode);

 private:
  using Matrix32 = Eigen::Matrix<double, 3, 2>;
  struct Element {
    Eigen::Matrix3d R;      // Left frame, world.
    Eigen::Matrix3d H;      // Block (Q, Q).
    Matrix32 U, V;          // Blocks (Q, P) = U_Q V_P^T.
    Eigen::Matrix3d L;      // Cholesky factor of the pivot,
    Matrix32 V_eliminated;  // and V less what earlier elements took.
  };

  // What Linearize's two passes share.
  struct Shape {
    math::Stumpff C;  // At |theta|^2.
    ElementEnd end;
  };

  double energy_ = 0;
  std::vector<Element> elements_;
  std::vector<Shape> shapes_;
  std::vector<Eigen::Vector3d> gradient_, metric_;
  std::vector<Eigen::Vector3d> work_;
};

}  // namespace mane::rod
