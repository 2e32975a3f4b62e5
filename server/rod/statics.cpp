#include "rod/statics.h"

#include <algorithm>

#include "base/check.h"
#include "rod/chain_hessian.h"
#include "rod/energy.h"
#include "rod/helix.h"
#include "rod/minimise.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// The energy of one strand over its 3N angles.
class StrandPotential : public Potential {
 public:
  StrandPotential(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity)
      : strand_(strand), clamp_(clamp), gravity_(gravity) {}

  [[nodiscard]] double Energy(const VectorXd& x) const override {
    return ElasticEnergy(strand_, Angles(x)) +
           GravityPotential(strand_, clamp_, gravity_, Angles(x));
  }
  [[nodiscard]] VectorXd Gradient(const VectorXd& x) const override {
    VectorXd g(x.size());
    PotentialGradient(strand_, clamp_, gravity_, Angles(x),
                      {reinterpret_cast<Vector3d*>(g.data()), static_cast<size_t>(x.size() / 3)});
    return g;
  }
  [[nodiscard]] MatrixXd Hessian(const VectorXd& x) const override {
    return ChainHessian<3>(*this, strand_, clamp_.q.toRotationMatrix(), gravity_, Angles(x));
  }
  // Of one element, for ChainHessian.
  [[nodiscard]] static ElementEnd End(int, const Vector3d& theta) { return EndOfElement(theta); }
  [[nodiscard]] Eigen::Matrix3d Stiffness(int Q) const {
    return (strand_.stiffness / strand_.length[Q]).asDiagonal();
  }
  // A moment to measure the residual by: the weight's largest, or the natural shape's.
  [[nodiscard]] double MomentScale() const {
    const double L = strand_.TotalLength();
    double scale = 0.5 * strand_.linear_density * gravity_.norm() * L * L;
    for (const Vector3d& natural : strand_.natural) {
      scale = std::max(scale, strand_.stiffness.cwiseProduct(natural).cwiseAbs().maxCoeff());
    }
    return std::max(scale, strand_.stiffness.minCoeff() / L);
  }

 private:
  static std::span<const Vector3d> Angles(const VectorXd& x) {
    return {reinterpret_cast<const Vector3d*>(x.data()), static_cast<size_t>(x.size() / 3)};
  }

  const Strand& strand_;
  const math::Pose& clamp_;
  const Vector3d& gravity_;
};

}  // namespace

StaticsReport SolveRestShape(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                             std::span<Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  const StrandPotential potential(strand, clamp, gravity);
  VectorXd x = Eigen::Map<const VectorXd>(theta[0].data(), 3 * N);
  VectorXd D(3 * N);  // The elastic stiffness: the metric of the trust region.
  for (int Q = 0; Q < N; ++Q) D.segment<3>(3 * Q) = strand.stiffness / strand.length[Q];
  const StaticsReport report = Minimise(potential, D, potential.MomentScale(), &x);
  Eigen::Map<VectorXd>(theta[0].data(), 3 * N) = x;
  return report;
}

}  // namespace mane::rod
