#include "rod/coarsen.h"

#include "base/check.h"
#include "rod/hessian.h"

namespace mane::rod {

using Eigen::Vector3d;

RestingStrand Coarsen(const RestingStrand& fine, const Parts& parts, const math::Pose& clamp,
                      const Vector3d& gravity, bool* stable) {
  MANE_CHECK(fine.rest.size() == parts.size() && fine.strand.length.size() == parts.size());
  RestingStrand coarse = fine;
  Strand& strand = coarse.strand;
  Merge(parts, &coarse.rest);
  Merge(parts, &strand.length);
  const int N = strand.elements();
  strand.natural.resize(N);
  for (int Q = 0; Q < N; ++Q) strand.natural[Q] = coarse.rest[Q] / strand.length[Q];
  // Without elastic forces, the gradient is that of weight alone, -load.
  PotentialHessian energy;
  energy.Linearize(strand, clamp, gravity, coarse.rest);
  for (int Q = 0; Q < N; ++Q) {
    strand.natural[Q] += energy.gradient()[Q].cwiseQuotient(strand.stiffness);
  }
  // The Hessian does not depend on the natural shape (I2).
  *stable = energy.Factor(-kCoarseMargin);
  return coarse;
}

}  // namespace mane::rod
