#include "rod/wound.h"

#include <cmath>
#include <utility>

#include "base/check.h"
#include "rod/recursion.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Fewer turns than this and the coil's ends, which C6 leaves out, matter more than its windings.
constexpr double kLeastTurns = 5;
// Plain elements follow a coil of half a turn each.
constexpr double kTurnsPerElement = 0.5;

// Geometry of all elements at the extrapolated unknowns, root to tip (S2, C4 to C8).
void Linearise(const WoundStrand& wound, const Matrix3d& root, double h, const WoundState& state,
               std::vector<LinearElement<4>>& elements) {
  Matrix3d A = root;
  for (int Q = 0; Q < wound.elements(); ++Q) {
    LinearElement<4>& element = elements[Q];
    const double l = wound.strand.length[Q];
    const CoilAxis axis = AxisOfElement(wound.coil, l, state.x[Q] + h * state.rate[Q]);
    const CoilEnd end = EndOfCoil(axis);
    element.length = l;
    element.mass = wound.strand.linear_density * l;
    element.K = wound.coil.stiffness / l;
    element.strain = state.x[Q];
    element.d = l * (A * end.p);
    element.S.topRows<3>() = l * A * end.J;
    element.S.bottomRows<3>() = A * end.T;
    element.c = l * (A * end.c);
    element.G = l * A * end.G;
    for (int g = 0; g < kGaussPoints; ++g) {
      const CoilPoint bead = PointOnCoil(axis, kGauss.nodes[g], BeadOffset(wound.coil, g) / l);
      element.r[g] = l * (A * bead.p);
      element.J[g] = l * A * bead.J;
    }
    A = A * end.E;
  }
}

}  // namespace

double NaturalTurns(const Strand& strand) {
  for (const Vector3d& natural : strand.natural) {
    if (natural != strand.natural[0] || !(natural.tail<2>().norm() > 0)) return 0;
  }
  return strand.natural[0].norm() * strand.TotalLength() / (2 * M_PI);
}

bool IsWound(const Strand& strand) {
  const double turns = NaturalTurns(strand);
  return turns > kTurnsPerElement * strand.elements() && turns >= kLeastTurns;
}

WoundStrand MakeWound(Strand strand) {
  MANE_CHECK(NaturalTurns(strand) > 0);
  const Coil coil = MakeCoil(strand.natural[0], strand.stiffness);
  // Less y(0) of the natural shape, whose phase at the root is 0.
  const Vector3d root = coil.F * Vector3d(0, 0, coil.radius);
  return {std::move(strand), coil, root};
}

bool Step(const WoundStrand& wound, const ClampMotion& clamp, const Surroundings& air,
          WoundState state, WoundScratch& scratch) {
  const int N = wound.elements();
  MANE_CHECK(static_cast<int>(state.x.size()) == N && clamp.dt > 0);
  if (static_cast<int>(scratch.elements.size()) < N) scratch.elements.resize(N);
  const recursion::Coefficients c = recursion::MakeCoefficients(wound.strand, clamp.dt, air);
  const Matrix3d R = math::Interpolate(clamp.begin, clamp.end, kTheta).q.toRotationMatrix();
  Linearise(wound, R * wound.coil.F, c.h, state, scratch.elements);
  // The clamp's twist where the axis starts (C10).
  recursion::Vector6d V = recursion::Twist(clamp);
  V.head<3>() += V.tail<3>().cross(R * wound.root);
  return recursion::Advance<4>(std::span(scratch.elements).first(N), c, clamp.dt, V, state.x,
                               state.rate, state.velocity);
}

}  // namespace mane::rod
