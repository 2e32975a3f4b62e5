#pragma once

#include <Eigen/Core>

#include <functional>
#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/step.h"
#include "rod/strand.h"

/// Brute-force Super-Helix in long double, which shares no formula with the code under test:
/// elements by [SH06] (7a), (7b), every derivative by finite differences, every integral by its own
/// Gauss rule, every solve dense.
namespace mane::rod::oracle {

using Real = long double;
using Vector3 = Eigen::Matrix<Real, 3, 1>;
using Matrix3 = Eigen::Matrix<Real, 3, 3>;
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Matrix3X = Eigen::Matrix<Real, 3, Eigen::Dynamic>;

/// Material frame and centreline point.
struct Frame {
  Matrix3 n = Matrix3::Identity();  ///< Columns n0, n1, n2.
  Vector3 r = Vector3::Zero();
};

[[nodiscard]] Frame ToFrame(const math::Pose& pose);
[[nodiscard]] Vector Stack(std::span<const Eigen::Vector3d> vectors);

/// Along an element of curvatures `kappa`, `s` on: [SH06] (7a), (7b).
[[nodiscard]] Frame Advance(const Frame& left, const Vector3& kappa, Real s);

/// The same by integrating (1a), (1b) with `steps` steps of RK4: error about
/// angle (angle / steps)^4 / 120.
[[nodiscard]] Frame IntegrateRk4(const Frame& left, const Vector3& kappa, Real s, int steps);

/// Nodes and weights on [0, 1] from the eigenvalues of the Jacobi matrix (Golub and Welsch).
struct Rule {
  std::vector<Real> nodes, weights;
};
[[nodiscard]] const Rule& GaussRule(int points);

/// A strand whose angles are a vector (3N).
class Rod {
 public:
  explicit Rod(const Strand& strand) : strand_(strand) {}

  [[nodiscard]] int elements() const { return strand_.elements(); }
  [[nodiscard]] Real length(int Q) const { return strand_.length[Q]; }

  /// Frame at the fraction `u` of element Q.
  [[nodiscard]] Frame At(const Frame& clamp, const Vector& theta, int Q, Real u) const;
  /// Points at the nodes of `rule` in all elements, root to tip, (3 x N points).
  [[nodiscard]] Matrix3X Points(const Frame& clamp, const Vector& theta, const Rule& rule) const;
  /// rho S ds at these points, (N points).
  [[nodiscard]] Vector Masses(const Rule& rule) const;
  /// Derivatives of these points by theta, fourth order differences: error about 1e-13 of them.
  [[nodiscard]] std::vector<Matrix3X> Jacobians(const Frame& clamp, const Vector& theta,
                                                const Rule& rule) const;

  /// W of the kinetic energy 1/2 sum W_kl u_k.u_l of the time step, by velocities at its Gauss
  /// points (S3, S12), (N points x N points), and the inertia matrix that follows.
  [[nodiscard]] Matrix StepMasses() const;
  [[nodiscard]] Matrix StepMass(const Frame& clamp, const Vector& theta) const;
  /// int rho S J^T J ds by `points` points an element.
  [[nodiscard]] Matrix Mass(const Frame& clamp, const Vector& theta, int points = 48) const;
  /// (5c), and -int rho S g.(r - r_clamp) ds with 48 points an element [J].
  [[nodiscard]] Real Elastic(const Vector& theta) const;
  [[nodiscard]] Real Gravity(const Frame& clamp, const Vector3& g, const Vector& theta) const;
  /// Gradient of their sum, fourth order differences.
  [[nodiscard]] Vector Gradient(const Frame& clamp, const Vector3& g, const Vector& theta) const;
  /// (S9) for the weight `w` [N/kg] at the right ends of all elements, as a quadratic form over
  /// rates.
  [[nodiscard]] Matrix Turning(const Frame& clamp, const Vector3& w, const Vector& theta) const;
  /// Diagonal of K in angles, (EI)_i / l, and gamma / l.
  [[nodiscard]] Vector Stiffness() const;
  [[nodiscard]] Vector Friction() const;
  /// l times the natural curvatures.
  [[nodiscard]] Vector Natural() const;

 private:
  const Strand& strand_;
};

/// One step of rod.md (S2) to (S4), assembled densely; advances `state`.
void DenseStep(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
               StrandState state);

/// Trajectory of [SH06] (4) under a prescribed clamp motion, by RK4 on
/// M qddot = int J^T (F - rho S b) ds - K (q - q^n) - D qdot, where b is the point's acceleration
/// at qddot = 0 and F the force (5a) with wind. Inertia and drag are summed over the step's few
/// Gauss points, so that both have one continuous limit; weight and wind are not.
struct Motion {
  Vector theta, rate;
};
[[nodiscard]] Motion IntegrateLagrange(const Strand& strand,
                                       const std::function<Frame(Real)>& clamp,
                                       const Surroundings& air, Motion motion, Real duration,
                                       int steps);

/// Velocities of the points at the nodes of `rule` when the angles and the clamp move, (3 x N
/// points).
[[nodiscard]] Matrix3X PointVelocities(const Strand& strand,
                                       const std::function<Frame(Real)>& clamp, Real t,
                                       const Motion& motion, const Rule& rule);

}  // namespace mane::rod::oracle
