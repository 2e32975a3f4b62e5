#include "rod/wound_shape.h"

#include "base/check.h"
#include "rod/chain.h"

namespace mane::rod {

using Eigen::Matrix3d;
using Eigen::Vector3d;

std::vector<WoundFrame> WoundFrames(const WoundStrand& wound, const math::Pose& clamp,
                                    std::span<const Vector4d> x) {
  const int N = wound.elements();
  MANE_CHECK(static_cast<int>(x.size()) == N);
  std::vector<WoundFrame> frames(N + 1);
  frames[0] = {clamp.q * wound.coil[0].F, clamp * wound.root, clamp.p, 0};
  for (int Q = 0; Q < N; ++Q) {
    const WoundFrame& left = frames[Q];
    const double l = wound.strand.length[Q];
    const CoilAxis axis = AxisOfElement(wound.coil[Q], l, x[Q]);
    const CoilEnd end = EndOfCoil(axis);
    frames[Q + 1] = {left.A * end.E, left.axis + l * (left.A * end.p),
                     left.hair + l * (left.A * HairOnCoil(axis, left.phase, 1)),
                     left.phase + axis.winding};
  }
  return frames;
}

Vector3d PointOnHair(const WoundStrand& wound, std::span<const WoundFrame> frames,
                     std::span<const Vector4d> x, double s) {
  const ArcPosition where = Locate(wound.strand, s);
  const int Q = where.element;
  const double l = wound.strand.length[Q];
  const CoilAxis axis = AxisOfElement(wound.coil[Q], l, x[Q]);
  return frames[Q].hair + l * (frames[Q].A * HairOnCoil(axis, frames[Q].phase, where.fraction));
}

double ElasticEnergy(const WoundStrand& wound, std::span<const Vector4d> x) {
  double U = 0;
  for (int Q = 0; Q < wound.elements(); ++Q) {
    const Vector4d strain = x[Q] - wound.natural[Q];
    U += 0.5 / wound.strand.length[Q] * strain.dot(wound.coil[Q].stiffness * strain);
  }
  return U;
}

double KineticEnergy(const WoundStrand& wound, std::span<const Vector3d> velocity) {
  double T = 0;
  for (int Q = 0; Q < wound.elements(); ++Q) {
    const double mass = wound.strand.linear_density * wound.strand.length[Q];
    for (int g = 0; g < kBeads; ++g) {
      T += 0.5 * mass * kBeadRule.weights[g] * velocity[Q * kBeads + g].squaredNorm();
    }
  }
  return T;
}

double GravityPotential(const WoundStrand& wound, const math::Pose& clamp, const Vector3d& gravity,
                        std::span<const Vector4d> x) {
  Matrix3d A = clamp.q * wound.coil[0].F;
  Vector3d r = clamp.q * wound.root;
  double V = 0;
  for (int Q = 0; Q < wound.elements(); ++Q) {
    const double l = wound.strand.length[Q];
    const CoilEnd end = EndOfCoil(AxisOfElement(wound.coil[Q], l, x[Q]));
    V -= wound.strand.linear_density * l * gravity.dot(r + l * (A * end.c));
    r += l * (A * end.p);
    A = A * end.E;
  }
  return V;
}

}  // namespace mane::rod
