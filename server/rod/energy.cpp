#include "rod/energy.h"

#include "base/check.h"
#include "rod/chain.h"
#include "rod/rotary_inertia.h"
#include "rod/scheme.h"

namespace mane::rod {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double ElasticEnergy(const Strand& strand, std::span<const Vector3d> theta) {
  double U = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const double l = strand.length[Q];
    const Vector3d stretch = theta[Q] - l * strand.natural[Q];
    U += 0.5 / l * stretch.cwiseProduct(strand.stiffness).dot(stretch);
  }
  return U;
}

double GravityPotential(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                        std::span<const Vector3d> theta) {
  Matrix3d R = clamp.q.toRotationMatrix();
  Vector3d r = Vector3d::Zero();
  double V = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const ElementEnd end = EndOfElement(theta[Q]);
    const double l = strand.length[Q];
    V -= strand.linear_density * l * gravity.dot(r + l * (R * end.c));
    r += l * (R * end.p);
    R = R * end.E;
  }
  return V;
}

void PotentialGradient(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                       std::span<const Vector3d> theta, std::span<Vector3d> gradient) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(gradient.size()) == N);
  const std::vector<ElementFrame> frames = ElementFrames(strand, clamp, theta);
  Vector3d force = Vector3d::Zero();   // Weight of all that hangs beyond the element's right end,
  Vector3d moment = Vector3d::Zero();  // and its moment about that end.
  for (int Q = N - 1; Q >= 0; --Q) {
    const ElementEnd end = EndOfElement(theta[Q]);
    const double l = strand.length[Q];
    const Matrix3d& R = frames[Q].R;
    const Vector3d weight = strand.linear_density * l * gravity;
    const Vector3d load = l * end.G.transpose() * (R.transpose() * weight) +
                          l * end.J.transpose() * (R.transpose() * force) +
                          end.T.transpose() * (R.transpose() * moment);
    const Vector3d elastic = strand.stiffness.cwiseProduct(theta[Q] / l - strand.natural[Q]);
    gradient[Q] = elastic - load;
    moment += (l * (R * end.p)).cross(force) + (l * (R * end.c)).cross(weight);
    force += weight;
  }
}

double KineticEnergy(const Strand& strand, std::span<const Vector3d> velocity) {
  const double rotary = RotaryInertia(strand);
  double T = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const Vector3d* const u = &velocity[Q * kGaussPoints];
    double squares = rotary * (u[kGaussPoints - 1] - u[0]).squaredNorm();
    for (int g = 0; g < kGaussPoints; ++g) squares += kGauss.weights[g] * u[g].squaredNorm();
    T += 0.5 * strand.linear_density * strand.length[Q] * squares;
  }
  return T;
}

}  // namespace mane::rod
