#include "rod/wound_statics.h"

#include <algorithm>

#include "base/check.h"
#include "rod/chain_hessian.h"
#include "rod/minimise.h"
#include "rod/wound_shape.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// The energy of one wound strand over its 4N unknowns.
class WoundPotential : public Potential {
 public:
  WoundPotential(const WoundStrand& wound, const math::Pose& clamp, const Vector3d& gravity)
      : wound_(wound), clamp_(clamp), gravity_(gravity) {}

  [[nodiscard]] double Energy(const VectorXd& x) const override {
    return ElasticEnergy(wound_, Unknowns(x)) +
           GravityPotential(wound_, clamp_, gravity_, Unknowns(x));
  }
  [[nodiscard]] VectorXd Gradient(const VectorXd& x) const override {
    VectorXd g(x.size());
    PotentialGradient(wound_, clamp_, gravity_, Unknowns(x),
                      {reinterpret_cast<Vector4d*>(g.data()), static_cast<size_t>(x.size() / 4)});
    return g;
  }
  [[nodiscard]] MatrixXd Hessian(const VectorXd& x) const override {
    return ChainHessian<4>(*this, wound_.strand, clamp_.q * wound_.coil.F, gravity_, Unknowns(x));
  }
  // Of one element, for ChainHessian.
  [[nodiscard]] CoilEnd End(int Q, const Vector4d& x) const {
    return EndOfCoil(AxisOfElement(wound_.coil, wound_.strand.length[Q], x));
  }
  [[nodiscard]] Eigen::Matrix4d Stiffness(int Q) const {
    return wound_.coil.stiffness / wound_.strand.length[Q];
  }

 private:
  static std::span<const Vector4d> Unknowns(const VectorXd& x) {
    return {reinterpret_cast<const Vector4d*>(x.data()), static_cast<size_t>(x.size() / 4)};
  }

  const WoundStrand& wound_;
  const math::Pose& clamp_;
  const Vector3d& gravity_;
};

}  // namespace

StaticsReport SolveRestShape(const WoundStrand& wound, const math::Pose& clamp,
                             const Vector3d& gravity, std::span<Vector4d> x) {
  const int N = wound.elements();
  MANE_CHECK(static_cast<int>(x.size()) == N);
  const WoundPotential potential(wound, clamp, gravity);
  VectorXd unknowns(4 * N), metric(4 * N);
  for (int Q = 0; Q < N; ++Q) {
    unknowns.segment<4>(4 * Q) = x[Q];
    metric.segment<4>(4 * Q) = wound.coil.stiffness.diagonal() / wound.strand.length[Q];
  }
  // The weight's largest moment, or the one that straightens the coil.
  const Strand& strand = wound.strand;
  const double L = strand.TotalLength();
  const double scale =
      std::max(0.5 * strand.linear_density * gravity.norm() * L * L,
               strand.stiffness.cwiseProduct(strand.natural[0]).cwiseAbs().maxCoeff());
  const StaticsReport report = Minimise(potential, metric, scale, &unknowns);
  for (int Q = 0; Q < N; ++Q) x[Q] = unknowns.segment<4>(4 * Q);
  return report;
}

}  // namespace mane::rod
