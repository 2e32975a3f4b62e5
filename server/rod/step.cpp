#include "rod/step.h"

#include "base/check.h"
#include "rod/helix.h"
#include "rod/recursion.h"
#include "rod/rotary_inertia.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Geometry of all elements and loads at the extrapolated angles, root to tip (S2).
void Linearise(const Strand& strand, const Matrix3d& root, double h,
               std::span<const PointLoad> loads, const StrandState& state, StepScratch& scratch) {
  scratch.loads.clear();
  scratch.first_load.assign(1, 0);
  const double rotary = RotaryInertia(strand);
  Matrix3d R = root;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    LinearElement<3>& element = scratch.elements[Q];
    const Vector3d theta = state.theta[Q] + h * state.rate[Q];
    const ElementEnd end = EndOfElement(theta);
    const double l = strand.length[Q];
    element.length = l;
    element.mass = strand.linear_density * l;
    element.rotary = rotary;
    element.K = (strand.stiffness / l).asDiagonal();
    element.strain = state.theta[Q] - l * strand.natural[Q];
    element.d = l * (R * end.p);
    element.S.topRows<3>() = l * R * end.J;
    element.S.bottomRows<3>() = R * end.T;
    element.c = l * (R * end.c);
    element.G = l * R * end.G;
    for (int g = 0; g < kGaussPoints; ++g) {
      const ElementPoint point = PointOnElement(theta, kGauss.nodes[g]);
      element.r[g] = l * (R * point.p);
      element.J[g] = l * R * point.J;
    }
    while (scratch.loads.size() < loads.size() && loads[scratch.loads.size()].element == Q) {
      const PointLoad& load = loads[scratch.loads.size()];
      const ElementPoint point = PointOnElement(theta, load.fraction);
      scratch.loads.push_back(
          {load.W, load.p, load.normal, load.surface_speed, l * (R * point.p), l * R * point.J});
    }
    scratch.first_load.push_back(static_cast<int>(scratch.loads.size()));
    R = R * end.E;
  }
  MANE_CHECK(scratch.loads.size() == loads.size());  // Else they are not in order.
}

}  // namespace

bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
          std::span<const PointLoad> loads, StrandState state, StepScratch& scratch) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(state.theta.size()) == N && clamp.dt > 0);
  if (static_cast<int>(scratch.elements.size()) < N) scratch.elements.resize(N);
  const recursion::Coefficients c = recursion::MakeCoefficients(strand, clamp.dt, air);
  const math::Pose middle = math::Interpolate(clamp.begin, clamp.end, kTheta);
  Linearise(strand, middle.q.toRotationMatrix(), c.h, loads, state, scratch);
  return recursion::Advance<3>(std::span(scratch.elements).first(N),
                               {scratch.loads, scratch.first_load}, c, clamp.dt,
                               recursion::Twist(clamp), state.theta, state.rate, state.velocity);
}

bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
          StrandState state, StepScratch& scratch) {
  return Step(strand, clamp, air, {}, state, scratch);
}

}  // namespace mane::rod
