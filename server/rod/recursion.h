#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "math/rigid.h"
#include "rod/scheme.h"
#include "rod/step.h"
#include "rod/strand.h"

/// S2 to S11 of rod.md for a chain of elements of n unknowns each: 3 where the strand itself is a
/// Super-Helix (step.cpp), 4 where its coil's axis is one (wound.cpp). Once an element is
/// linearised, which is up to its kind, they differ in n alone. Internal to this folder.
namespace mane::rod::recursion {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Matrix6d = Eigen::Matrix<double, 6, 6>;
using Vector6d = Eigen::Matrix<double, 6, 1>;

/// Constants of one step.
struct Coefficients {
  double h;        ///< kTheta dt [s]
  double inertia;  ///< 1 + h c: implicit drag multiplies inertia.
  Vector3d body;   ///< h (g + c wind) [m/s]: momentum per mass from gravity and moving air.
  double gamma;    ///< Internal friction, scaled.
};

inline Coefficients MakeCoefficients(const Strand& strand, double dt, const Surroundings& air) {
  const double h = kTheta * dt;
  const double c = air.air_drag_scale * strand.air_drag / strand.linear_density;
  return {h, 1 + h * c, h * (air.gravity + c * air.wind),
          air.internal_friction_scale * strand.internal_friction};
}

/// The clamp's twist (velocity [m/s], spin [rad/s]) over a step.
inline Vector6d Twist(const ClampMotion& clamp) {
  Vector6d V;
  V.head<3>() = (clamp.end.p - clamp.begin.p) / clamp.dt;
  V.tail<3>() = math::RotationVector(clamp.end.q * clamp.begin.q.conjugate()) / clamp.dt;
  return V;
}

/// What an element and all beyond it cost, 1/2 V.A V - b.V, where V is the twist (velocity, spin)
/// of the element's left end, once their rates are eliminated.
struct CostToGo {
  Matrix6d A = Matrix6d::Zero();
  Vector6d b = Vector6d::Zero();
};

/// One element's cost before elimination: quadratic form over (v, V).
template <int n>
struct Cost {
  Eigen::Matrix<double, n, n> Hvv = Eigen::Matrix<double, n, n>::Zero();
  Eigen::Matrix<double, n, 6> HvV = Eigen::Matrix<double, n, 6>::Zero();
  Eigen::Matrix<double, n, 1> gv = Eigen::Matrix<double, n, 1>::Zero();
  CostToGo V;
};

// Weights of the points of an element of n unknowns.
template <int n>
constexpr const double* Weights() {
  if constexpr (n == 4) {
    return kBeadRule.weights;
  } else {
    return kGauss.weights;
  }
}

// Adds 1/2 m scale |P V + J v|^2 - m u.(P V + J v), where P V = translation velocity + spin x r:
// the cost of a point of mass m at r, or, without translation, of the difference of two.
template <int n>
void AddPoint(double m, double scale, double translation, const Vector3d& r,
              const Eigen::Matrix<double, 3, n>& J, const Vector3d& u, Cost<n>* cost) {
  const double M = m * scale;
  const Matrix3d rx = math::Cross(r);
  cost->Hvv.noalias() += M * J.transpose() * J;
  cost->HvV.template leftCols<3>() += translation * M * J.transpose();
  cost->HvV.template rightCols<3>().noalias() -= M * J.transpose() * rx;
  cost->gv.noalias() += m * J.transpose() * u;
  cost->V.A.template topLeftCorner<3, 3>().diagonal().array() += translation * M;
  cost->V.A.template topRightCorner<3, 3>() -= translation * M * rx;
  cost->V.A.template bottomRightCorner<3, 3>().noalias() -= M * rx * rx;
  cost->V.b.template head<3>() += translation * m * u;
  cost->V.b.template tail<3>() += m * r.cross(u);
}

// Adds the inertia of all points of an element (scaled by the implicit drag), and what the outer
// ones resist turning by (S12).
template <int n>
void AddInertia(const LinearElement<n>& element, double scale, const Vector3d* u, Cost<n>* cost) {
  constexpr int kLast = LinearElement<n>::kPoints - 1;
  for (int g = 0; g <= kLast; ++g) {
    AddPoint<n>(element.mass * Weights<n>()[g], scale, 1, element.r[g], element.J[g], u[g], cost);
  }
  AddPoint<n>(element.mass * element.rotary, scale, 0, element.r[kLast] - element.r[0],
              element.J[kLast] - element.J[0], u[kLast] - u[0], cost);
  cost->V.A.template bottomLeftCorner<3, 3>() =
      cost->V.A.template topRightCorner<3, 3>().transpose();
}

/// The loads of all elements (S13); none where they are of no kind that bears any.
struct Loads {
  std::span<const LinearLoad> all;
  std::span<const int> first;  // By element, and their number at the end.

  [[nodiscard]] std::span<const LinearLoad> Of(int Q) const {
    if (all.empty()) return {};
    return all.subspan(first[Q], first[Q + 1] - first[Q]);
  }
};

// Adds 1/2 u.W u - p.u with u = velocity + spin x r + J v.
inline void AddLoad(const LinearLoad& load, Cost<3>* cost) {
  const Matrix3d rx = math::Cross(load.r);
  const Matrix3d JW = load.J.transpose() * load.W, Wr = load.W * rx;
  cost->Hvv.noalias() += JW * load.J;
  cost->HvV.leftCols<3>() += JW;
  cost->HvV.rightCols<3>().noalias() -= JW * rx;
  cost->gv.noalias() += load.J.transpose() * load.p;
  cost->V.A.topLeftCorner<3, 3>() += load.W;
  cost->V.A.topRightCorner<3, 3>() -= Wr;
  cost->V.A.bottomLeftCorner<3, 3>() -= Wr.transpose();
  cost->V.A.bottomRightCorner<3, 3>().noalias() -= rx * Wr;
  cost->V.b.head<3>() += load.p;
  cost->V.b.tail<3>() += load.r.cross(load.p);
}

// Adds -m body.(velocity of the centre of mass).
template <int n>
void AddBodyForce(const LinearElement<n>& element, const Vector3d& body, Cost<n>* cost) {
  const Vector3d momentum = element.mass * body;
  cost->gv.noalias() += element.G.transpose() * momentum;
  cost->V.b.template head<3>() += momentum;
  cost->V.b.template tail<3>() += element.c.cross(momentum);
}

// Adds 1/2 v.(h D + h^2 K) v + h v.K (x - x^n), where the friction D is gamma / l, and h K / 2 at
// least (S10).
template <int n>
void AddElasticity(const LinearElement<n>& element, const Coefficients& c, Cost<n>* cost) {
  const Eigen::Matrix<double, n, n> stiff = c.h * c.h * element.K;
  Eigen::Matrix<double, n, n> friction = kLeastFriction * stiff;
  friction.diagonal() = friction.diagonal().cwiseMax(c.h * c.gamma / element.length);
  cost->Hvv += stiff + friction;
  cost->gv.noalias() -= c.h * element.K * element.strain;
}

// The convex part of the quadratic form (w.D) |x|^2 - (w.x)(D.x): how much higher a weight w hangs
// that is turned by the rotation vector x at the end of an arm D (S9).
inline Matrix3d TurningStiffness(const Vector3d& w, const Vector3d& D) {
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
// right ends of all elements. `omega` is the root's spin.
template <int n>
void AddWeights(std::span<LinearElement<n>> elements, double h, const Vector3d& weight,
                Vector3d omega, std::span<const Eigen::Matrix<double, n, 1>> rate) {
  const int N = static_cast<int>(elements.size());
  for (int Q = 0; Q < N; ++Q) {
    omega += elements[Q].S.template bottomRows<3>() * rate[Q];
    elements[Q].spin = omega;
  }
  double beyond = 0;
  Vector3d next = Vector3d::Zero();  // Arm of the element beyond.
  for (int Q = N - 1; Q >= 0; --Q) {
    const Vector3d arm = beyond * elements[Q].d + elements[Q].mass * elements[Q].c;
    elements[Q].weight = h * TurningStiffness(weight, 0.5 * (arm + next));
    next = arm;
    beyond += elements[Q].mass;
  }
}

// Adds the cost beyond the right end, whose twist is X V + S v with X = (I, -[d]; 0, I).
template <int n>
void AddBeyond(const LinearElement<n>& element, const CostToGo& beyond, Cost<n>* cost) {
  Matrix6d X = Matrix6d::Identity();
  X.topRightCorner<3, 3>() = -math::Cross(element.d);
  const Matrix6d AX = beyond.A * X;
  cost->Hvv.noalias() += element.S.transpose() * beyond.A * element.S;
  cost->HvV.noalias() += element.S.transpose() * AX;
  cost->gv.noalias() += element.S.transpose() * beyond.b;
  cost->V.A.noalias() += X.transpose() * AX;
  cost->V.b.noalias() += X.transpose() * beyond.b;
}

// Minimises over v: v = k - L V, and leaves the cost over V alone.
template <int n>
CostToGo Eliminate(const Cost<n>& cost, LinearElement<n>* element) {
  const Eigen::LDLT<Eigen::Matrix<double, n, n>> factor(cost.Hvv);
  element->L = factor.solve(cost.HvV);
  element->k = factor.solve(cost.gv);
  CostToGo left = cost.V;
  left.A.noalias() -= cost.HvV.transpose() * element->L;
  left.A = 0.5 * (left.A + left.A.transpose()).eval();
  left.b.noalias() -= cost.HvV.transpose() * element->k;
  return left;
}

/// S9, S5 to S7 tip to root, then S11 and S4 root to tip, where the root's twist V is known, so
/// that all others are.
///
/// @param elements  linearised at the extrapolated unknowns, root first.
/// @param x, rate   unknowns and their rates, (N); in and out.
/// @param velocity  at the Gauss points [m/s], (N x kPoints); in and out.
/// @return whether the result is finite.
template <int n>
bool Advance(std::span<LinearElement<n>> elements, const Loads& loads, const Coefficients& c,
             double dt, Vector6d V, std::span<Eigen::Matrix<double, n, 1>> x,
             std::span<Eigen::Matrix<double, n, 1>> rate, std::span<Vector3d> velocity) {
  constexpr int kPoints = LinearElement<n>::kPoints;
  const int N = static_cast<int>(elements.size());
  AddWeights<n>(elements, c.h, c.body - (c.inertia - 1) * V.head<3>(), V.tail<3>(), rate);
  CostToGo beyond;
  for (int Q = N - 1; Q >= 0; --Q) {
    Cost<n> cost;
    AddInertia(elements[Q], c.inertia, &velocity[Q * kPoints], &cost);
    AddBodyForce(elements[Q], c.body, &cost);
    AddElasticity(elements[Q], c, &cost);
    if constexpr (n == 3) {
      for (const LinearLoad& load : loads.Of(Q)) AddLoad(load, &cost);
    }
    beyond.A.bottomRightCorner<3, 3>() += elements[Q].weight;
    beyond.b.tail<3>() += elements[Q].weight * elements[Q].spin;
    AddBeyond(elements[Q], beyond, &cost);
    beyond = Eliminate(cost, &elements[Q]);
  }

  double magnitude = 0;
  for (int Q = 0; Q < N; ++Q) {
    const LinearElement<n>& element = elements[Q];
    Eigen::Matrix<double, n, 1> v = element.k - element.L * V;
    v *= std::min(1.0, kLargestTurn / std::max(dt * v.norm(), 1e-300));  // S11
    for (int g = 0; g < kPoints; ++g) {
      Vector3d& u = velocity[Q * kPoints + g];
      const Vector3d u_x = V.head<3>() + V.tail<3>().cross(element.r[g]) + element.J[g] * v;
      u += (u_x - u) / kTheta;
      for (const LinearLoad& load : loads.Of(Q)) {  // S14
        u -= std::max(0.0, load.normal.dot(u) - load.surface_speed) * load.normal;
      }
      magnitude += u.squaredNorm();
    }
    rate[Q] = v;
    x[Q] += dt * v;
    magnitude += x[Q].squaredNorm();
    V.head<3>() += V.tail<3>().cross(element.d);
    V += element.S * v;
  }
  return std::isfinite(magnitude);
}

}  // namespace mane::rod::recursion
