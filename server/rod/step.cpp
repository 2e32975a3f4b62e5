#include "rod/step.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>

#include "base/check.h"
#include "rod/helix.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Matrix36d = Eigen::Matrix<double, 3, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;
using Element = StepScratch::Element;
using math::Cross;

// The step as a minimisation over rates v and element twists V = (velocity, angular velocity) of
// left ends: what an element and all beyond it cost is 1/2 V.A V - b.V once their rates are
// eliminated, tip to root (rod.md, S5 to S7).
struct CostToGo {
  Matrix6d A = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
};

// One element's cost before elimination: quadratic form over (v, V).
struct ElementCost {
  Matrix3d Hvv = Matrix3d::Zero();
  Matrix36d HvV = Matrix36d::Zero();
  Vector3d gv = Vector3d::Zero();
  CostToGo V;
};

// Constants of one step.
struct Coefficients {
  double h;        // kTheta dt
  double inertia;  // 1 + h c: implicit drag multiplies inertia.
  Vector3d body;   // h (g + c wind): momentum per mass from gravity and moving air.
  double gamma;    // internal friction, scaled
};

Coefficients MakeCoefficients(const Strand& strand, double dt, const Surroundings& air) {
  const double h = kTheta * dt;
  const double c = air.air_drag_scale * strand.air_drag / strand.linear_density;
  return {h, 1 + h * c, h * (air.gravity + c * air.wind),
          air.internal_friction_scale * strand.internal_friction};
}

// Adds 1/2 m |P V + J v|^2 (scaled by the implicit drag) - m u.(P V + J v) for each Gauss point,
// where P V = velocity + omega x r.
void AddInertia(const Element& element, double mass, double scale, const Vector3d* u,
                ElementCost* cost) {
  for (int g = 0; g < kGaussPoints; ++g) {
    const double m = mass * kGauss.weights[g], M = m * scale;
    const Matrix3d& J = element.J[g];
    const Vector3d& r = element.r[g];
    const Matrix3d rx = Cross(r);
    cost->Hvv.noalias() += M * J.transpose() * J;
    cost->HvV.leftCols<3>() += M * J.transpose();
    cost->HvV.rightCols<3>().noalias() -= M * J.transpose() * rx;
    cost->gv.noalias() += m * J.transpose() * u[g];
    cost->V.A.topLeftCorner<3, 3>().diagonal().array() += M;
    cost->V.A.topRightCorner<3, 3>() -= M * rx;
    cost->V.A.bottomRightCorner<3, 3>().noalias() -= M * rx * rx;
    cost->V.b.head<3>() += m * u[g];
    cost->V.b.tail<3>() += m * r.cross(u[g]);
  }
}

// Adds -m body.(velocity of the centre of mass), exact for a helix.
void AddBodyForce(const Element& element, const ElementEnd& end, double l, double mass,
                  const Vector3d& body, ElementCost* cost) {
  const Vector3d momentum = mass * body;
  cost->gv += l * end.G.transpose() * (element.R.transpose() * momentum);
  cost->V.b.head<3>() += momentum;
  cost->V.b.tail<3>() += (l * (element.R * end.c)).cross(momentum);
}

// Adds 1/2 v.(h gamma + h^2 K) v + h v.K (theta - theta_natural).
void AddElasticity(const Strand& strand, int Q, const Vector3d& theta, const Coefficients& c,
                   ElementCost* cost) {
  const double l = strand.length[Q];
  const Vector3d K = strand.stiffness / l;
  const Vector3d stiff = c.h * c.h * K;
  cost->Hvv.diagonal() += stiff + (kLeastFriction * stiff).cwiseMax(c.h * c.gamma / l);
  cost->gv -= c.h * K.cwiseProduct(theta - l * strand.natural[Q]);
}

// The convex part of the quadratic form (w.D) |x|^2 - (w.x)(D.x): how much higher a weight w hangs
// that is turned by the rotation vector x at the end of an arm D (S9).
Matrix3d TurningStiffness(const Vector3d& w, const Vector3d& D) {
  const double size = w.norm() * D.norm();
  if (size == 0) return Matrix3d::Zero();
  const Vector3d a = w.normalized(), b = D.normalized();
  const double cosine = a.dot(b);
  const Matrix3d across = (a - b) * (a - b).transpose();
  if (cosine <= 0) return size * (1 + cosine) / (4 - 4 * cosine) * across;
  const Matrix3d along = (a + b) * (a + b).transpose();
  return size * (cosine * (Matrix3d::Identity() - along / (2 + 2 * cosine)) + across / 4);
}

// Turning stiffness of `weight`, h (g + drag of the air that passes), and extrapolated spins at the
// right ends of all elements.
void AddWeights(const Strand& strand, double h, const Vector3d& weight, const StrandState& state,
                const Vector3d& spin, std::vector<Element>& elements,
                const std::vector<ElementEnd>& ends) {
  const int N = strand.elements();
  Vector3d omega = spin;
  for (int Q = 0; Q < N; ++Q) {
    omega += elements[Q].S.bottomRows<3>() * state.rate[Q];
    elements[Q].spin = omega;
  }
  double beyond = 0;
  Vector3d next = Vector3d::Zero();  // Arm of the element beyond.
  for (int Q = N - 1; Q >= 0; --Q) {
    const double l = strand.length[Q], mass = strand.linear_density * l;
    const Vector3d arm = beyond * elements[Q].d + mass * l * (elements[Q].R * ends[Q].c);
    elements[Q].weight = h * TurningStiffness(weight, 0.5 * (arm + next));
    next = arm;
    beyond += mass;
  }
}

// Adds the cost beyond the right end, whose twist is X V + S v with X = (I, -[d]; 0, I).
void AddBeyond(const Element& element, const CostToGo& beyond, ElementCost* cost) {
  Matrix6d X = Matrix6d::Identity();
  X.topRightCorner<3, 3>() = -Cross(element.d);
  const Matrix6d AX = beyond.A * X;
  cost->Hvv.noalias() += element.S.transpose() * beyond.A * element.S;
  cost->HvV.noalias() += element.S.transpose() * AX;
  cost->gv.noalias() += element.S.transpose() * beyond.b;
  cost->V.A.noalias() += X.transpose() * AX;
  cost->V.b.noalias() += X.transpose() * beyond.b;
}

// Minimises over v: v = k - L V, and leaves the cost over V alone.
CostToGo Eliminate(const ElementCost& cost, Element* element) {
  const Eigen::LDLT<Matrix3d> factor(cost.Hvv);
  element->L = factor.solve(cost.HvV);
  element->k = factor.solve(cost.gv);
  CostToGo left = cost.V;
  left.A.noalias() -= cost.HvV.transpose() * element->L;
  left.A = 0.5 * (left.A + left.A.transpose()).eval();
  left.b.noalias() -= cost.HvV.transpose() * element->k;
  return left;
}

// Geometry of all elements at the extrapolated angles, root to tip.
void Linearise(const Strand& strand, const Matrix3d& root, double h, const StrandState& state,
               std::vector<Element>& elements, std::vector<ElementEnd>& ends) {
  Matrix3d R = root;
  for (int Q = 0; Q < strand.elements(); ++Q) {
    Element& element = elements[Q];
    const Vector3d theta = state.theta[Q] + h * state.rate[Q];
    const ElementEnd& end = ends[Q] = EndOfElement(theta);
    const double l = strand.length[Q];
    element.R = R;
    element.d = l * (R * end.p);
    element.S.topRows<3>() = l * R * end.J;
    element.S.bottomRows<3>() = R * end.T;
    for (int g = 0; g < kGaussPoints; ++g) {
      const ElementPoint point = PointOnElement(theta, kGauss.nodes[g]);
      element.r[g] = l * (R * point.p);
      element.J[g] = l * R * point.J;
    }
    R = R * end.E;
  }
}

}  // namespace

bool Step(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
          StrandState state, StepScratch& scratch) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(state.theta.size()) == N && clamp.dt > 0);
  if (static_cast<int>(scratch.elements.size()) < N) {
    scratch.elements.resize(N);
    scratch.ends.resize(N);
  }
  const Coefficients c = MakeCoefficients(strand, clamp.dt, air);
  const math::Pose middle = math::Interpolate(clamp.begin, clamp.end, kTheta);
  Linearise(strand, middle.q.toRotationMatrix(), c.h, state, scratch.elements, scratch.ends);

  // Tip to root: eliminate each element's rates.
  const Vector3d velocity = (clamp.end.p - clamp.begin.p) / clamp.dt;
  const Vector3d spin = math::RotationVector(clamp.end.q * clamp.begin.q.conjugate()) / clamp.dt;
  AddWeights(strand, c.h, c.body - (c.inertia - 1) * velocity, state, spin, scratch.elements,
             scratch.ends);
  CostToGo beyond;
  for (int Q = N - 1; Q >= 0; --Q) {
    Element& element = scratch.elements[Q];
    const double mass = strand.linear_density * strand.length[Q];
    ElementCost cost;
    AddInertia(element, mass, c.inertia, &state.velocity[Q * kGaussPoints], &cost);
    cost.V.A.bottomLeftCorner<3, 3>() = cost.V.A.topRightCorner<3, 3>().transpose();
    AddBodyForce(element, scratch.ends[Q], strand.length[Q], mass, c.body, &cost);
    AddElasticity(strand, Q, state.theta[Q], c, &cost);
    beyond.A.bottomRightCorner<3, 3>() += element.weight;
    beyond.b.tail<3>() += element.weight * element.spin;
    AddBeyond(element, beyond, &cost);
    beyond = Eliminate(cost, &element);
  }

  // Root to tip: the clamp's twist is known, so are all others.
  Vector6d V;
  V.head<3>() = velocity;
  V.tail<3>() = spin;
  double magnitude = 0;
  for (int Q = 0; Q < N; ++Q) {
    const Element& element = scratch.elements[Q];
    Vector3d v = element.k - element.L * V;
    v *= std::min(1.0, kLargestTurn / std::max(clamp.dt * v.norm(), 1e-300));
    for (int g = 0; g < kGaussPoints; ++g) {
      Vector3d& u = state.velocity[Q * kGaussPoints + g];
      const Vector3d u_theta = V.head<3>() + V.tail<3>().cross(element.r[g]) + element.J[g] * v;
      u += (u_theta - u) / kTheta;
      magnitude += u.squaredNorm();
    }
    state.rate[Q] = v;
    state.theta[Q] += clamp.dt * v;
    magnitude += state.theta[Q].squaredNorm();
    V.head<3>() += V.tail<3>().cross(element.d);
    V += element.S * v;
  }
  return std::isfinite(magnitude);
}

}  // namespace mane::rod
