#pragma once

/// The time step of step.h for a block of strands, one strand per lane; only for sources that
/// define MANE_ISA. Nothing here may instantiate a template of the standard library: the linker
/// would keep one copy of it, perhaps one with instructions that another machine lacks.

#include "rod/batch_recursion.h"

namespace mane::rod {
namespace MANE_ISA {

/// Strands whose centreline is a Super-Helix.
template <typename T, int W>
class StrandStep : Recursion<T, W> {
  using Base = Recursion<T, W>;
  using Base::AddShifted;
  using Base::AddWeight;
  using Base::All;
  using Base::Damped;
  using Base::EndTurn;
  using Base::Expect;
  using Base::Next;
  using Base::Prepare;
  using Base::Put;
  using Base::ReadClamp;
  using Base::Reduce;
  using Base::Row;
  using Base::Rows;
  using typename Base::Clamp;
  using typename Base::Constants;
  using typename Base::CostToGo;
  using typename Base::ElementLoads;
  using typename Base::Field;
  using typename Base::NoLoads;
  using typename Base::PointLoad;
  using typename Base::Turning;
  using typename Base::V;
  using typename Base::Vec;

 public:
  using typename Base::PointShape;
  /// What a step keeps of an element between its passes.
  struct Element {
    Frame<V> R;            // Left frame at the linearisation.
    Vec th, A;             // theta, theta x d0; B = theta x A = tau theta - zeta d0.
    Vec spin;              // Right end's extrapolated angular velocity.
    Vec led;               // What led the right end there (Approach).
    V tau, zeta;           // theta.d0, |theta|^2
    V c2, c3, c4, c5, c6;  // c_n(zeta)
    // Of an element of length 1, by combinations of the Gauss points; phi1 is kNode.
    V phi2[kGaussPoints], phi3[kGaussPoints], psi2[kGaussPoints], psi3[kGaussPoints];
    Lower<V> L;  // rates = L^-T (z - Z1 velocity - Z2 spin)
    Matrix<V> Z1, Z2;
    Vec z;

    [[nodiscard]] Vec B() const { return tau * th - zeta * R.n0; }
  };

  /// Advances W strands of N elements. `scratch` has room for N elements. `size` gets the largest
  /// |theta|^2 of each strand, 1e30 where its new state is not finite.
  static void Step(int N, const T* constants, const T* drive, T* state, Element* scratch, T* size);

  /// The same in two parts, with loads in the second (batch_loads.h, which defines both).
  static void Approach(int N, const int* first_point, const T* constants, const T* drive,
                       const T* state, Element* scratch, PointShape* shapes, T* points);
  static void Solve(int N, const int* first_point, const T* constants, const T* drive,
                    const T* state, const T* loads, const unsigned char* loaded,
                    const unsigned char* watched, Element* scratch, const PointShape* shapes,
                    T* next, T* velocities, T* size, T* turning);

 private:
  // The part of an element's cost that has its rates v: 1/2 v.H v + v.(Hv1 velocity + Hv2 spin) -
  // g.v.
  struct RateCost {
    Symmetric<V> H;
    Matrix<V> Hv1, Hv2;
    Vec g;
  };

  // Loads on points of one element.
  struct Loads;

  // What is taken of the Gauss points: the middle one, sum and difference of the outer ones. So the
  // difference may have an inertia of its own (S12).
  enum Combination { kMiddle, kSum, kDifference };
  static constexpr T kNode[3] = {T(kGauss.nodes[1]), T(kGauss.nodes[2] + kGauss.nodes[0]),
                                 T(kGauss.nodes[2] - kGauss.nodes[0])};
  template <typename X>
  static void Combine(const X (&at)[kGaussPoints], X (&combined)[kGaussPoints]) {
    combined[kMiddle] = at[1], combined[kSum] = at[2] + at[0],
    combined[kDifference] = at[2] - at[0];
  }

  static void Linearise(int N, const Clamp& clamp, const V& h, const T* state, Element* elements);
  // batch_inertia.h
  static void AddInertia(const Constants& step, const V& rotary, const V& length, const T* state,
                         const Element& element, RateCost& rates, CostToGo& left);
  static void AddElasticity(const Constants& step, const Vec& stiffness, const T* constants,
                            const T* state, const Element& element, RateCost& rates);
  // Of the right end.
  static PointShape EndShape(const Element& e) {
    return {e.c2, e.c3, T(2) * e.c4 - e.c3, T(3) * e.c5 - e.c4};
  }
  // Where a point at the fraction s is from the left end, and the columns of its velocity per rate
  // (H6).
  static void PointColumns(const Element& element, const V& length, const T& s,
                           const PointShape& shape, Vec& d, Vec (&J)[3]);
  static Field FieldOf(const Element& element, const V& length, const Vec& spin, const Vec& v);
  // Columns of T of the right end (H5).
  static void EndTurns(const Element& element, Vec (&S)[3]);
  // What lies beyond the right end, whose twist is X (velocity; spin) + S v (S6).
  static void AddBeyond(const V& length, const Element& element, const CostToGo& beyond,
                        RateCost& rates, CostToGo& left);
  // The same at the tip, beyond which lies only the tip's own weight, which only turns.
  static void AddTip(const Element& element, const CostToGo& beyond, RateCost& rates,
                     CostToGo& left);
  static void Eliminate(const RateCost& rates, Element& element, CostToGo& left);
  // Tip to root: one element's costs and those beyond it, without its rates. What only one of the
  // two ends needs is left out at the other.
  template <bool tip, bool root, typename L>
  static void GoThrough(const Constants& step, const V& rotary, const Vec& stiffness,
                        const T* constants, const T* state, const L& loads, Element& element,
                        CostToGo& beyond);
  template <typename L>
  static V Advance(const V& dt, const T* constants, const L& loads, Element& element, Vec& velocity,
                   Vec& spin, const T* state, T* next);
  // S5 to S7 and S4, after Linearise. `loads_of(Q)` are those of an element.
  template <typename LoadsOf>
  static void SolveWith(int N, const Clamp& clamp, const Constants& step, const T* constants,
                        const T* drive, const T* state, const LoadsOf& loads_of, Element* scratch,
                        T* next, T* size, T* turning);
};

// Root to tip: frames and shapes at the extrapolated angles.
template <typename T, int W>
void StrandStep<T, W>::Linearise(int N, const Clamp& clamp, const V& h, const T* state,
                                 Element* elements) {
  Frame<V> R = clamp.root;
  Vec omega = clamp.spin;
  for (int Q = 0; Q < N; ++Q, state += layout::kStatePerElement * layout::kLanes) {
    Element& e = elements[Q];
    const Vec rate = Rows(state, layout::kRates);
    const Vec q = Rows(state, layout::kAngles) + h * rate;
    e.R = R;
    e.th = R * q;
    e.A = Cross(e.th, R.n0);
    e.tau = q.x;
    e.zeta = Dot(q, q);
    const Reduction<T, V> reduction = Reduce(e.zeta);
    V phi2[kGaussPoints], phi3[kGaussPoints], psi2[kGaussPoints], psi3[kGaussPoints];
#pragma GCC unroll 3
    for (int g = 0; g < kGaussPoints; ++g) {
      const T s = T(kGauss.nodes[g]);
      const Stumpff<V> c = Base::template Evaluate<false>(reduction, s);
      phi2[g] = (s * s) * c.c2;
      phi3[g] = (s * s * s) * c.c3;
      psi2[g] = (s * s * s * s) * (T(2) * c.c4 - c.c3);
      psi3[g] = (s * s * s * s * s) * (T(3) * c.c5 - c.c4);
    }
    Combine(phi2, e.phi2), Combine(phi3, e.phi3), Combine(psi2, e.psi2), Combine(psi3, e.psi3);
    const Stumpff<V> c = Base::template Evaluate<true>(reduction, T(1));
    e.c2 = c.c2, e.c3 = c.c3, e.c4 = c.c4, e.c5 = c.c5, e.c6 = c.c6;
    omega += EndTurn(e.th, R * rate, c.c2, c.c3);
    e.spin = omega;
    R = Next(R, q, c);
  }
}

template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::AddElasticity(const Constants& step,
                                                                   const Vec& stiffness,
                                                                   const T* constants,
                                                                   const T* state, const Element& e,
                                                                   RateCost& rates) {
  const V inverse = Row(constants, layout::kInverseLength);
  const Vec hk = (step.h * inverse) * stiffness;
  const Vec force = Times(hk, Rows(state, layout::kAngles) - Rows(constants, layout::kNatural));
  const V friction = step.friction * inverse;
  const Vec stiff = step.h * hk;
  const Vec k{Damped(stiff.x, friction), Damped(stiff.y, friction), Damped(stiff.z, friction)};
  rates.g -= e.R * force;
  // sum k_i n_i n_i^T, of which k_1 n_1 n_1^T = k_1 (1 - n_0 n_0^T - n_2 n_2^T).
  const V even = k.y;
  rates.H.xx += even, rates.H.yy += even, rates.H.zz += even;
  AddOuter(rates.H, (k.x - k.y) * e.R.n0, e.R.n0);
  AddOuter(rates.H, (k.z - k.y) * e.R.n2, e.R.n2);
}

template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::EndTurns(const Element& e, Vec (&S)[3]) {
  const Vec th = e.th, a = e.c2 * th, b = e.c3 * th;
  const V turn = T(1) - e.zeta * e.c3;
  S[0] = th.x * b, S[1] = th.y * b, S[2] = th.z * b;
  S[0].x += turn, S[0].y += a.z, S[0].z -= a.y;
  S[1].x -= a.z, S[1].y += turn, S[1].z += a.x;
  S[2].x += a.y, S[2].y -= a.x, S[2].z += turn;
}

template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::AddTip(const Element& e,
                                                            const CostToGo& beyond, RateCost& rates,
                                                            CostToGo& left) {
  Vec S[3];
  EndTurns(e, S);
  const Vec Q[3] = {beyond.A22 * S[0], beyond.A22 * S[1], beyond.A22 * S[2]};
  rates.Hv2.x += Q[0], rates.Hv2.y += Q[1], rates.Hv2.z += Q[2];
  rates.g += Vec{Dot(S[0], beyond.b2), Dot(S[1], beyond.b2), Dot(S[2], beyond.b2)};
  rates.H.xx += Dot(S[0], Q[0]), rates.H.xy += Dot(S[0], Q[1]), rates.H.xz += Dot(S[0], Q[2]);
  rates.H.yy += Dot(S[1], Q[1]), rates.H.yz += Dot(S[1], Q[2]), rates.H.zz += Dot(S[2], Q[2]);
  left.A22 += beyond.A22;
  left.b2 += beyond.b2;
}

template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::AddBeyond(const V& length, const Element& e,
                                                               const CostToGo& beyond,
                                                               RateCost& rates, CostToGo& left) {
  Vec S[3], J[3], d;
  EndTurns(e, S);
  PointColumns(e, length, T(1), EndShape(e), d, J);

  Vec P[3], Q[3];  // A S, by columns.
  for (int i = 0; i < 3; ++i) {
    P[i] = beyond.A11 * J[i] + beyond.A12 * S[i];
    Q[i] = beyond.A22 * S[i] + TransposeTimes(beyond.A12, J[i]);
  }
  rates.Hv1.x += P[0], rates.Hv1.y += P[1], rates.Hv1.z += P[2];
  rates.Hv2.x += Q[0] + Cross(d, P[0]);
  rates.Hv2.y += Q[1] + Cross(d, P[1]);
  rates.Hv2.z += Q[2] + Cross(d, P[2]);
  rates.g +=
      Vec{Dot(J[0], beyond.b1) + Dot(S[0], beyond.b2), Dot(J[1], beyond.b1) + Dot(S[1], beyond.b2),
          Dot(J[2], beyond.b1) + Dot(S[2], beyond.b2)};
  rates.H.xx += Dot(J[0], P[0]) + Dot(S[0], Q[0]);
  rates.H.xy += Dot(J[0], P[1]) + Dot(S[0], Q[1]);
  rates.H.xz += Dot(J[0], P[2]) + Dot(S[0], Q[2]);
  rates.H.yy += Dot(J[1], P[1]) + Dot(S[1], Q[1]);
  rates.H.yz += Dot(J[1], P[2]) + Dot(S[1], Q[2]);
  rates.H.zz += Dot(J[2], P[2]) + Dot(S[2], Q[2]);

  AddShifted(beyond, d, left);
}

template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::PointColumns(const Element& e, const V& length,
                                                                  const T& s,
                                                                  const PointShape& shape, Vec& d,
                                                                  Vec (&J)[3]) {
  const Vec d0 = e.R.n0, th = e.th;
  const V tau = e.tau, phi2 = length * shape.phi2, phi3 = length * shape.phi3;
  const V psi2 = length * shape.psi2, psi3 = length * shape.psi3;
  d = (s * length - e.zeta * phi3) * d0 + phi2 * e.A + (tau * phi3) * th;
  const Vec C = psi2 * e.A + (psi3 * tau) * th - (psi3 * e.zeta + T(2) * phi3) * d0;
  const Vec f = phi3 * d0, p = phi2 * d0;
  const V diagonal = phi3 * tau;
  J[0] = f.x * th + th.x * C, J[1] = f.y * th + th.y * C, J[2] = f.z * th + th.z * C;
  J[0].x += diagonal, J[0].y -= p.z, J[0].z += p.y;
  J[1].x += p.z, J[1].y += diagonal, J[1].z -= p.x;
  J[2].x -= p.y, J[2].y += p.x, J[2].z += diagonal;
}

template <typename T, int W>
[[gnu::always_inline]] inline typename StrandStep<T, W>::Field StrandStep<T, W>::FieldOf(
    const Element& e, const V& length, const Vec& spin, const Vec& v) {
  const Vec d0 = e.R.n0, lw = length * spin, lv = length * v, B = e.B();
  const V dot = Dot(e.th, lv);
  return {Cross(lw, d0), Cross(lw, e.A) + Cross(lv, d0),
          Cross(lw, B) + e.tau * lv + Dot(d0, lv) * e.th - (T(2) * dot) * d0, dot * e.A, dot * B};
}

// The rates by the left end's twist, and the cost of that alone (S7).
template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::Eliminate(const RateCost& rates, Element& e,
                                                               CostToGo& left) {
  const Factor<V> H(rates.H, All(sizeof(T) == 4 ? 1e-6 : 1e-15));
  e.L = H.L;
  // In the factored basis: Z = L^-1 Hv, of which D^-1 Z is kept.
  Matrix<V> Z1 = rates.Hv1, Z2 = rates.Hv2;
  Vec z = rates.g;
  H.L.Forward(Z1);
  H.L.Forward(Z2);
  H.L.Forward(z);
  e.Z1 = H.OverD(Z1);
  e.Z2 = H.OverD(Z2);
  e.z = H.OverD(z);
  SubtractProduct(left.A11, Z1, e.Z1);
  SubtractProduct(left.A12, Z1, e.Z2);
  SubtractProduct(left.A22, Z2, e.Z2);
  left.b1 -= TransposeTimes(Z1, e.z);
  left.b2 -= TransposeTimes(Z2, e.z);
}

// Root to tip: rates from the left end's twist, the new state, the right end's twist. Returns a sum
// that is finite just where all that is new is.
template <typename T, int W>
template <typename L>
[[gnu::always_inline]] inline typename StrandStep<T, W>::V StrandStep<T, W>::Advance(
    const V& dt, const T* constants, const L& loads, Element& e, Vec& velocity, Vec& spin,
    const T* state, T* new_state) {
  Vec v = e.L.Backward(e.z - e.Z1 * velocity - e.Z2 * spin);
  const V turned = dt * dt * Dot(v, v);
  const auto far = turned > T(kLargestTurn * kLargestTurn);
  if (simd::MANE_ISA::Any(far)) {
    const V scale = T(kLargestTurn) / simd::MANE_ISA::Sqrt(turned);
    v = (far ? scale : All(1)) * v;
  }
  const Field along = FieldOf(e, Row(constants, layout::kLength), spin, v);
  Vec field[kGaussPoints];  // By combinations.
#pragma GCC unroll 3
  for (int k = 0; k < kGaussPoints; ++k) {
    field[k] = along.At(All(kNode[k]), {e.phi2[k], e.phi3[k], e.psi2[k], e.psi3[k]});
  }
  const V half = All(0.5);
  const Vec u_theta[kGaussPoints] = {velocity + half * (field[kSum] - field[kDifference]),
                                     velocity + field[kMiddle],
                                     velocity + half * (field[kSum] + field[kDifference])};
  V sum{};
#pragma GCC unroll 3
  for (int g = 0; g < kGaussPoints; ++g) {
    const Vec u = Rows(state, layout::kVelocities + 3 * g);
    Vec next = u + All(1 / kTheta) * (u_theta[g] - u);
    loads.Stop(next);
    Put(next, new_state, layout::kVelocities + 3 * g);
    sum += next.x + next.y + next.z;
  }
  loads.Show(along, velocity);
  const Vec rate = TransposeTimes(e.R, v);
  const Vec q = Rows(state, layout::kAngles) + dt * rate;
  Put(rate, new_state, layout::kRates);
  Put(q, new_state, layout::kAngles);
  velocity += along.At(All(1), EndShape(e));
  spin += EndTurn(e.th, v, e.c2, e.c3);
  return sum + (q.x + q.y + q.z);
}

template <typename T, int W>
template <bool tip, bool root, typename L>
[[gnu::always_inline]] inline void StrandStep<T, W>::GoThrough(
    const Constants& step, const V& rotary, const Vec& stiffness, const T* constants,
    const T* state, const L& loads, Element& e, CostToGo& beyond) {
  const V length = Row(constants, layout::kLength);
  RateCost rates{};
  CostToGo left{};
  AddInertia(step, rotary, length, state, e, rates, left);
  AddElasticity(step, stiffness, constants, state, e, rates);
  loads.Add(length, e, rates, left);
  const Vec B = e.B(), end = e.R.n0 + e.c2 * e.A + e.c3 * B;
  const Vec centre = All(0.5) * e.R.n0 + e.c3 * e.A + e.c4 * B;
  if constexpr (tip) beyond = CostToGo{};
  left.arm = length * (beyond.mass * end + length * centre);
  left.mass = beyond.mass + length;
  AddWeight(step, e.spin, All(0.5) * (left.arm + beyond.arm), beyond);
  if constexpr (tip) {
    AddTip(e, beyond, rates, left);
  } else {
    AddBeyond(length, e, beyond, rates, left);
  }
  loads.Steady(left);
  Eliminate(rates, e, left);
  if constexpr (!root) beyond = left;
}

template <typename T, int W>
template <typename LoadsOf>
[[gnu::always_inline]] inline void StrandStep<T, W>::SolveWith(
    int N, const Clamp& clamp, const Constants& step, const T* constants, const T* drive,
    const T* state, const LoadsOf& loads_of, Element* scratch, T* next, T* size, T* turning) {
  const Vec stiffness = Rows(constants, layout::kStiffness);
  const V rotary = Row(constants, layout::kRotaryInertia);
  constexpr int kConstants = layout::kConstantsPerElement * layout::kLanes;
  constexpr int kState = layout::kStatePerElement * layout::kLanes;
  const T* element_constants = constants + layout::kFirstElement * layout::kLanes;
  const T* const next_constants = element_constants + N * kConstants;
  Expect(next_constants, layout::kFirstElement);
  CostToGo beyond{};
  const auto go = [&]<bool tip, bool root>(int Q) __attribute__((always_inline)) {
    Expect(state + (N + Q) * kState, layout::kStatePerElement);
    Expect(next_constants + layout::kFirstElement * layout::kLanes + Q * kConstants,
           layout::kConstantsPerElement);
    GoThrough<tip, root>(step, rotary, stiffness, element_constants + Q * kConstants,
                         state + Q * kState, loads_of(Q), scratch[Q], beyond);
  };
  if (N == 1) {
    go.template operator()<true, true>(0);
  } else {
    go.template operator()<true, false>(N - 1);
    for (int Q = N - 2; Q > 0; --Q) go.template operator()<false, false>(Q);
    go.template operator()<false, true>(0);
  }

  const V dt = Row(drive, layout::kDuration);
  Vec velocity = clamp.velocity, spin = clamp.spin;
  V sum{}, largest{};
  Turning turned(clamp);
  for (int Q = 0; Q < N; ++Q) {
    const T* const own = element_constants + Q * kConstants;
    sum += Advance(dt, own, loads_of(Q), scratch[Q], velocity, spin, state + Q * kState,
                   next + Q * kState);
    if (turning != nullptr) {
      const Element& e = scratch[Q];
      const V length = Row(own, layout::kLength);
      turned.Add(velocity - All(kTheta) * e.led, spin - All(kTheta) * e.spin,
                 length * (e.R.n0 + e.c2 * e.A + e.c3 * e.B()));
    }
    const Vec q = Rows(next + Q * kState, layout::kAngles);
    const V square = Dot(q, q);
    largest = square > largest ? square : largest;
  }
  const auto finite = (sum < T(1e30)) & (sum > T(-1e30));
  simd::MANE_ISA::Store(finite ? largest : All(1e30), size);
  if (turning == nullptr) return;
  const V half = T(0.5) * Row(constants, layout::kUnit);
  simd::MANE_ISA::Store(half * simd::MANE_ISA::Sqrt(turned.most), turning);
}

template <typename T, int W>
void StrandStep<T, W>::Step(int N, const T* constants, const T* drive, T* state, Element* scratch,
                            T* size) {
  const Clamp clamp = ReadClamp(constants, drive);
  const Constants step = Prepare(constants, drive, clamp.velocity);
  Linearise(N, clamp, step.h, state, scratch);
  SolveWith(
      N, clamp, step, constants, drive, state, [](int) { return NoLoads{}; }, scratch, state, size,
      nullptr);
}

}  // namespace MANE_ISA
}  // namespace mane::rod
