#include "rod/wound.h"

#include <Eigen/Geometry>

#include <algorithm>
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
// An element that hardly winds has a coil as wide as it is long, and a loading may unwind it.
constexpr double kLeastTurnsOfElement = 0.2;
// Nearly pure twist has no coil to speak of, and no direction of one.
constexpr double kLeastSlant = 1e-3;

// Geometry of all elements at the extrapolated unknowns, root to tip (S2, C4 to C8).
void Linearise(const WoundStrand& wound, const Matrix3d& root, double h, const WoundState& state,
               std::vector<LinearElement<4>>& elements) {
  Matrix3d A = root;
  for (int Q = 0; Q < wound.elements(); ++Q) {
    LinearElement<4>& element = elements[Q];
    const double l = wound.strand.length[Q];
    const CoilAxis axis = AxisOfElement(wound.coil[Q], l, state.x[Q] + h * state.rate[Q]);
    const CoilEnd end = EndOfCoil(axis);
    element.length = l;
    element.mass = wound.strand.linear_density * l;
    element.rotary = 0;
    element.K = wound.coil[Q].stiffness / l;
    element.strain = state.x[Q] - wound.natural[Q];
    element.d = l * (A * end.p);
    element.S.topRows<3>() = l * A * end.J;
    element.S.bottomRows<3>() = A * end.T;
    element.c = l * (A * end.c);
    element.G = l * A * end.G;
    for (int g = 0; g < kBeads; ++g) {
      const CoilPoint bead =
          PointOnCoil(axis, kBeadRule.nodes[g], BeadOffset(wound.coil[Q], g) / l);
      element.r[g] = l * (A * bead.p);
      element.J[g] = l * A * bead.J;
    }
    A = A * end.E;
  }
}

std::vector<Coil> CoilsOf(const Strand& strand) {
  std::vector<Coil> coils;
  coils.reserve(strand.natural.size());
  for (const Vector3d& natural : strand.natural) {
    coils.push_back(MakeCoil(natural, strand.stiffness));
  }
  return coils;
}

// x^n (C12). The material frame is continuous, so that the axis turns at a joint of two coils; half
// of that turn is the natural curvature of either element.
std::vector<Vector4d> NaturalUnknowns(const Strand& strand, const std::vector<Coil>& coils) {
  const int N = strand.elements();
  std::vector<Vector4d> natural(N);
  Eigen::Quaterniond left = Eigen::Quaterniond::Identity();  // Half of the last joint's turn.
  double phase = 0;
  for (int Q = 0; Q < N; ++Q) {
    phase += coils[Q].winding * strand.length[Q];
    Eigen::Quaterniond right = Eigen::Quaterniond::Identity();
    if (Q + 1 < N) {
      const Eigen::Quaterniond wind(Eigen::AngleAxisd(phase, Vector3d::UnitX()));
      const Eigen::Quaterniond kink(coils[Q].F.transpose() * coils[Q + 1].F);
      right = Eigen::Quaterniond::Identity().slerp(0.5, wind * kink * wind.conjugate());
    }
    // beta = (u, b1, b2) where xi = 0.
    natural[Q] << math::RotationVector(left * right), 0;
    left = right;
  }
  return natural;
}

}  // namespace

double NaturalTurns(const Strand& strand) {
  double angle = 0;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    if (!(strand.natural[Q].tail<2>().norm() > 0)) return 0;
    angle += strand.natural[Q].norm() * strand.length[Q];
  }
  return angle / (2 * M_PI);
}

bool IsWound(const Strand& strand) {
  const double turns = NaturalTurns(strand);
  if (!(turns > kTurnsPerElement * strand.elements() && turns >= kLeastTurns)) return false;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const double winding = strand.natural[Q].norm();
    if (winding * strand.length[Q] < 2 * M_PI * kLeastTurnsOfElement) return false;
    if (strand.natural[Q].tail<2>().norm() < kLeastSlant * winding) return false;
  }
  const std::vector<Coil> coils = CoilsOf(strand);
  for (size_t Q = 1; Q < coils.size(); ++Q) {
    if (Eigen::AngleAxisd(coils[Q - 1].F.transpose() * coils[Q].F).angle() > kLargestKink) {
      return false;
    }
  }
  return true;
}

double CoilWeight(const Strand& strand) {
  constexpr double kGravity = 9.81;  // [m/s^2]
  double most = 0, beyond = 0;       // Length beyond the element's left end.
  for (int Q = strand.elements() - 1; Q >= 0; --Q) {
    beyond += strand.length[Q];
    const Vector3d& natural = strand.natural[Q];
    const double radius = natural.tail<2>().norm() / natural.squaredNorm();
    const double moment = strand.stiffness.cwiseProduct(natural).tail<2>().norm();
    most = std::max(most, strand.linear_density * kGravity * beyond * radius / moment);
  }
  return most;
}

WoundStrand MakeWound(Strand strand) {
  MANE_CHECK(NaturalTurns(strand) > 0);
  std::vector<Coil> coils = CoilsOf(strand);
  std::vector<Vector4d> natural = NaturalUnknowns(strand, coils);
  // Less y(0) of the natural shape, whose phase at the root is 0.
  const Vector3d root = coils[0].F * Vector3d(0, 0, coils[0].radius);
  return {std::move(strand), std::move(coils), std::move(natural), root};
}

bool Step(const WoundStrand& wound, const ClampMotion& clamp, const Surroundings& air,
          WoundState state, WoundScratch& scratch) {
  const int N = wound.elements();
  MANE_CHECK(static_cast<int>(state.x.size()) == N && clamp.dt > 0);
  if (static_cast<int>(scratch.elements.size()) < N) scratch.elements.resize(N);
  const recursion::Coefficients c = recursion::MakeCoefficients(wound.strand, clamp.dt, air);
  const Matrix3d R = math::Interpolate(clamp.begin, clamp.end, kTheta).q.toRotationMatrix();
  Linearise(wound, R * wound.coil[0].F, c.h, state, scratch.elements);
  // The clamp's twist where the axis starts (C10).
  recursion::Vector6d V = recursion::Twist(clamp);
  V.head<3>() += V.tail<3>().cross(R * wound.root);
  return recursion::Advance<4>(std::span(scratch.elements).first(N), {}, c, clamp.dt, V, state.x,
                               state.rate, state.velocity);
}

}  // namespace mane::rod
