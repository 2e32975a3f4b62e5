#pragma once

/// The time step of wound.h for a block of strands, one strand per lane; only for sources that
/// define MANE_ISA. As batch_step.h, but its elements have four unknowns (coil.md, C2).

#include "rod/batch_factor.h"
#include "rod/batch_wound_axis.h"

namespace mane::rod {
namespace MANE_ISA {

/// Strands of which the axis of their coil is a Super-Helix.
template <typename T, int W>
class WoundStep : WoundAxis<T, W> {
  using Base = WoundAxis<T, W>;
  using Base::AddShifted;
  using Base::AddWeight;
  using Base::All;
  using Base::AxisOf;
  using Base::Damped;
  using Base::EndTurn;
  using Base::Next;
  using Base::Prepare;
  using Base::Put;
  using Base::ReadClamp;
  using Base::Reduce;
  using Base::Row;
  using Base::Rows;
  using typename Base::Axis;
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
  static constexpr int n = 4;

  /// What a step keeps of an element between its passes.
  struct Element {
    Frame<V> R;  // Left axis frame at the linearisation.
    Vec th, A;   // R beta, th x d0
    Vec spin;    // Right end's extrapolated angular velocity.
    Vec led;     // What led the right end there (Approach).
    Axis axis;
    V zeta;                // |beta|^2
    V c2, c3, c4, c5, c6;  // c_n(zeta)
    // At the Gauss points, for an element of length 1, and where its bead is from the axis.
    V phi2[kBeads], phi3[kBeads], psi2[kBeads], psi3[kBeads];
    Vec bead[kBeads];
    LowerOf<V, n> L;   // rates = L^-T (z - Z1 velocity - Z2 spin)
    Vec Z1[n], Z2[n];  // by rows
    V z[n];

    [[nodiscard]] Vec B() const { return axis.beta.x * th - zeta * R.n0; }
  };

  /// As StrandStep::Step; `size` gets the largest |x|^2.
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
  // g.v, H its lower triangle, Hv by rows.
  struct RateCost {
    V H[n][n];
    Vec Hv1[n], Hv2[n];
    V g[n];
  };
  // Loads on points of one element's axis.
  struct Loads;

  // Columns of the derivatives of a point and of the frame there by the unknowns.
  struct Columns {
    Vec J[n];
  };
  // What |theta|-columns need of an element: n_j, th x n_j, th x (th x n_j).
  struct Turns {
    Vec n[3], once[3], twice[3];
    explicit Turns(const Element& e);
    // T of (H5): column j, by (s, phi2, phi3).
    [[nodiscard]] Vec Column(int j, const V& s, const V& phi2, const V& phi3) const {
      return s * n[j] + phi2 * once[j] + phi3 * twice[j];
    }
  };

  static void Linearise(int N, const Clamp& clamp, const V& h, const T* constants, const T* state,
                        Element* elements);
  // dp/dx of the axis (C5), by the columns of dp_H/dbeta; p is p_H.
  static Columns AxisColumns(const Element& e, const Vec& p, const V& phi2, const V& phi3,
                             const V& psi2, const V& psi3);
  // T dbeta/dx from T.
  static Columns TurnColumns(const Element& e, const Vec (&turn)[3]);
  static void AddInertia(const Constants& step, const V& length, const T* state, const Element& e,
                         const Turns& turns, RateCost& rates, CostToGo& left);
  static void AddElasticity(const Constants& step, const T* constants, const T* state,
                            RateCost& rates);
  static void AddBeyond(const V& length, const Element& e, const Turns& turns,
                        const CostToGo& beyond, RateCost& rates, CostToGo& left);
  static void Eliminate(const RateCost& rates, Element& e, CostToGo& left);
  // Velocities along the axis for unknowns' rates v.
  static Field FieldOf(const Element& element, const V& length, const Vec& spin, const V (&v)[n]);
  static PointShape EndShape(const Element& e) {
    return {e.c2, e.c3, T(2) * e.c4 - e.c3, T(3) * e.c5 - e.c4};
  }
  template <typename L>
  static V Advance(const V& dt, const T* constants, const L& loads, const Element& e, Vec& velocity,
                   Vec& spin, const T* state, T* next);
  // The clamp of the axis, which starts off the hair (C10).
  static Clamp AxisClamp(const T* constants, const T* drive) {
    Clamp clamp = ReadClamp(constants, drive);
    const T* const own = constants + layout::kFirstElement * layout::kLanes;
    clamp.velocity += Cross(clamp.spin, Row(own, layout::kRadius) * clamp.root.n2);
    return clamp;
  }
  // S5 to S7 and S4, after Linearise. `loads_of(Q)` are those of an element.
  template <typename LoadsOf>
  static void SolveWith(int N, const Clamp& clamp, const Constants& step, const T* constants,
                        const T* drive, const T* state, const LoadsOf& loads_of, Element* scratch,
                        T* next, T* size, T* turning);
};

template <typename T, int W>
[[gnu::always_inline]] inline WoundStep<T, W>::Turns::Turns(const Element& e)
    : n{e.R.n0, e.R.n1, e.R.n2} {
  for (int j = 0; j < 3; ++j) {
    once[j] = Cross(e.th, n[j]);
    twice[j] = Cross(e.th, once[j]);
  }
}

// Root to tip: axis frames and shapes at the extrapolated unknowns (S2, C4).
template <typename T, int W>
void WoundStep<T, W>::Linearise(int N, const Clamp& clamp, const V& h, const T* constants,
                                const T* state, Element* elements) {
  Frame<V> R = clamp.root;
  Vec omega = clamp.spin;
  for (int Q = 0; Q < N; ++Q) {
    Element& e = elements[Q];
    V x[n], rate[n];
    for (int i = 0; i < n; ++i) {
      rate[i] = Row(state, layout::kUnknownRates + i);
      x[i] = Row(state, layout::kUnknowns + i) + h * rate[i];
    }
    e.axis = AxisOf(constants, x);
    const Vec beta = e.axis.beta;
    e.R = R;
    e.th = R * beta;
    e.A = Cross(e.th, R.n0);
    e.zeta = Dot(beta, beta);
    const Reduction<T, V> reduction = Reduce(e.zeta);
    const V radius =
        T(0.5) * Row(constants, layout::kRadius) * Row(constants, layout::kInverseLength);
#pragma GCC unroll 4
    for (int g = 0; g < kBeads; ++g) {
      const T s = T(kBeadRule.nodes[g]);
      const Stumpff<V> c = Base::template Evaluate<false>(reduction, s);
      e.phi2[g] = (s * s) * c.c2;
      e.phi3[g] = (s * s * s) * c.c3;
      e.psi2[g] = (s * s * s * s) * (T(2) * c.c4 - c.c3);
      e.psi3[g] = (s * s * s * s * s) * (T(3) * c.c5 - c.c4);
      // C7: outer beads stand along e1, inner ones along e2, to either side.
      const bool outer = g == 0 || g == kBeads - 1;
      const T sign = T((2 * g < kBeads ? 1 : -1) / __builtin_sqrt(kBeadRule.weights[g]));
      const Vec o = (sign * radius) * (outer ? R.n1 : R.n2), turn = Cross(e.th, o);
      e.bead[g] = o + (s * c.c1) * turn + e.phi2[g] * Cross(e.th, turn);
    }
    const Stumpff<V> c = Base::template Evaluate<true>(reduction, T(1));
    e.c2 = c.c2, e.c3 = c.c3, e.c4 = c.c4, e.c5 = c.c5, e.c6 = c.c6;
    omega += EndTurn(e.th, R * e.axis.AngleRates(rate), c.c2, c.c3);
    e.spin = omega;
    R = Next(R, beta, c);
    constants += layout::kConstantsPerWoundElement * layout::kLanes;
    state += layout::kStatePerWoundElement * layout::kLanes;
  }
}

template <typename T, int W>
[[gnu::always_inline]] inline typename WoundStep<T, W>::Columns WoundStep<T, W>::AxisColumns(
    const Element& e, const Vec& p, const V& phi2, const V& phi3, const V& psi2, const V& psi3) {
  const Axis& axis = e.axis;
  const Vec X = psi2 * e.A + psi3 * e.B(), d0 = e.R.n0;
  const V tau = axis.beta.x, twice = T(2) * phi3;
  // dp_H/dbeta times n_j (H6), j = 0, 1, 2.
  const Vec H0 = phi3 * (e.th - tau * d0) + tau * X;
  const Vec H1 = (phi3 * tau) * e.R.n1 - phi2 * e.R.n2 + axis.beta.y * (X - twice * d0);
  const Vec H2 = (phi3 * tau) * e.R.n2 + phi2 * e.R.n1 + axis.beta.z * (X - twice * d0);
  const Vec twist = axis.stretch * H0;
  return {{axis.along * twist + axis.stretch_by_u * p, axis.stretch * H1, axis.stretch * H2,
           axis.across * twist + axis.stretch_by_xi * p}};
}

template <typename T, int W>
[[gnu::always_inline]] inline typename WoundStep<T, W>::Columns WoundStep<T, W>::TurnColumns(
    const Element& e, const Vec (&turn)[3]) {
  return {{e.axis.along * turn[0], turn[1], turn[2], e.axis.across * turn[0]}};
}

// 1/2 M |velocity + spin x r + J v|^2 - m u.(the same) at the beads, and weight as momentum spread
// evenly along the axis (C7, C8).
template <typename T, int W>
[[gnu::always_inline]] inline void WoundStep<T, W>::AddInertia(const Constants& step,
                                                               const V& length, const T* state,
                                                               const Element& e, const Turns& turns,
                                                               RateCost& rates, CostToGo& left) {
  const V length2 = length * length, mass = length * step.inertia;
  Vec first{};            // sum m r
  Symmetric<V> second{};  // sum m r r^T
#pragma GCC unroll 4
  for (int g = 0; g < kBeads; ++g) {
    const V s = All(kBeadRule.nodes[g]), w = All(kBeadRule.weights[g]);
    const V phi2 = e.phi2[g], phi3 = e.phi3[g];
    const Vec p = s * e.R.n0 + phi2 * e.A + phi3 * e.B(), o = e.bead[g];
    Columns J = AxisColumns(e, p, phi2, phi3, e.psi2[g], e.psi3[g]);
    const Vec turn0 = Cross(turns.Column(0, s, phi2, phi3), o);
    J.J[0] += e.axis.along * turn0;
    J.J[1] += Cross(turns.Column(1, s, phi2, phi3), o);
    J.J[2] += Cross(turns.Column(2, s, phi2, phi3), o);
    J.J[3] += e.axis.across * turn0;
    const Vec r = e.axis.stretch * p + o;
    const Vec u = Rows(state, layout::kBeadVelocities + 3 * g);
    const Vec wu = w * u, wr = w * r;
    for (int i = 0; i < n; ++i) {
      const Vec wJ = w * J.J[i];
      for (int j = 0; j <= i; ++j) rates.H[i][j] += Dot(wJ, J.J[j]);
      rates.Hv1[i] += wJ;
      rates.Hv2[i] += Cross(r, wJ);
      rates.g[i] += Dot(J.J[i], wu);
    }
    first += wr;
    AddOuter(second, wr, r);
    left.b1 += wu;
    left.b2 += Cross(r, wu);
  }
  // Weight, at the centre of the axis.
  const Vec centre = All(0.5) * e.R.n0 + e.c3 * e.A + e.c4 * e.B();
  const Columns G = AxisColumns(e, centre, e.c3, e.c4, T(3) * e.c5 - e.c4, T(4) * e.c6 - e.c5);
  left.b1 += step.body;
  left.b2 += Cross(e.axis.stretch * centre, step.body);
  for (int i = 0; i < n; ++i) rates.g[i] += Dot(G.J[i], step.body);

  // Of an element of its own length and mass.
  const V I1 = length * mass, I2 = length * I1;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j <= i; ++j) rates.H[i][j] *= I2;
    rates.Hv1[i] = I1 * rates.Hv1[i];
    rates.Hv2[i] = I2 * rates.Hv2[i];
    rates.g[i] *= length2;
  }
  left.b1 = length * left.b1;
  left.b2 = length2 * left.b2;
  left.A11.xx += mass, left.A11.yy += mass, left.A11.zz += mass;
  left.A12 -= CrossMatrix(I1 * first);
  Symmetric<V> inertia{};
  AddInertiaOf(inertia, second);
  left.A22 += I2 * inertia;
}

// C6, S3, S10.
template <typename T, int W>
[[gnu::always_inline]] inline void WoundStep<T, W>::AddElasticity(const Constants& step,
                                                                  const T* constants,
                                                                  const T* state, RateCost& rates) {
  const V inverse = Row(constants, layout::kInverseLength), hl = step.h * inverse;
  const V friction = step.friction * inverse;
  V x[n];
  for (int i = 0; i < n; ++i) {
    x[i] = Row(state, layout::kUnknowns + i) - Row(constants, layout::kNaturalUnknowns + i);
  }
  const V twist = hl * Row(constants, layout::kTwisting),
          bend = hl * Row(constants, layout::kBending);
  const V stretch = hl * Row(constants, layout::kStretching);
  const V couple = hl * Row(constants, layout::kCoupling);
  rates.g[0] -= twist * x[0] + couple * x[3];
  rates.g[1] -= bend * x[1];
  rates.g[2] -= bend * x[2];
  rates.g[3] -= stretch * x[3] + couple * x[0];
  const V bent = Damped(step.h * bend, friction);
  rates.H[0][0] += Damped(step.h * twist, friction);
  rates.H[1][1] += bent;
  rates.H[2][2] += bent;
  rates.H[3][3] += Damped(step.h * stretch, friction);
  rates.H[3][0] += T(1 + kLeastFriction) * step.h * couple;
}

// What lies beyond the right end, whose twist is X (velocity; spin) + S v (S6).
template <typename T, int W>
[[gnu::always_inline]] inline void WoundStep<T, W>::AddBeyond(const V& length, const Element& e,
                                                              const Turns& turns,
                                                              const CostToGo& beyond,
                                                              RateCost& rates, CostToGo& left) {
  const Vec p = e.R.n0 + e.c2 * e.A + e.c3 * e.B();
  Columns J = AxisColumns(e, p, e.c2, e.c3, T(2) * e.c4 - e.c3, T(3) * e.c5 - e.c4);
  Vec turn[3];
  for (int j = 0; j < 3; ++j) turn[j] = turns.Column(j, All(1), e.c2, e.c3);
  const Columns S = TurnColumns(e, turn);
  for (int i = 0; i < n; ++i) J.J[i] = length * J.J[i];
  const Vec d = (length * e.axis.stretch) * p;
  Vec P[n], Q[n];  // A S, by columns.
  for (int i = 0; i < n; ++i) {
    P[i] = beyond.A11 * J.J[i] + beyond.A12 * S.J[i];
    Q[i] = beyond.A22 * S.J[i] + TransposeTimes(beyond.A12, J.J[i]);
  }
  for (int i = 0; i < n; ++i) {
    rates.Hv1[i] += P[i];
    rates.Hv2[i] += Q[i] + Cross(d, P[i]);
    rates.g[i] += Dot(J.J[i], beyond.b1) + Dot(S.J[i], beyond.b2);
    for (int j = 0; j <= i; ++j) rates.H[i][j] += Dot(J.J[i], P[j]) + Dot(S.J[i], Q[j]);
  }
  AddShifted(beyond, d, left);
}

// The rates by the left end's twist, and the cost of that alone (S7).
template <typename T, int W>
[[gnu::always_inline]] inline void WoundStep<T, W>::Eliminate(const RateCost& rates, Element& e,
                                                              CostToGo& left) {
  const FactorOf<V, n> H(rates.H, All(sizeof(T) == 4 ? 1e-6 : 1e-15));
  e.L = H.L;
  Vec Z1[n], Z2[n];
  V z[n];
  for (int i = 0; i < n; ++i) Z1[i] = rates.Hv1[i], Z2[i] = rates.Hv2[i], z[i] = rates.g[i];
  H.L.Forward(Z1);
  H.L.Forward(Z2);
  H.L.Forward(z);
  for (int i = 0; i < n; ++i) {
    e.Z1[i] = H.inverse[i] * Z1[i];
    e.Z2[i] = H.inverse[i] * Z2[i];
    e.z[i] = H.inverse[i] * z[i];
    AddOuter(left.A11, -Z1[i], e.Z1[i]);
    AddOuter(left.A12, -Z1[i], e.Z2[i]);
    AddOuter(left.A22, -Z2[i], e.Z2[i]);
    left.b1 -= e.z[i] * Z1[i];
    left.b2 -= e.z[i] * Z2[i];
  }
}

// Root to tip: rates from the left end's twist, the new state, the right end's twist. Returns a sum
// that is finite just where all that is new is.
template <typename T, int W>
[[gnu::always_inline]] inline typename WoundStep<T, W>::Field WoundStep<T, W>::FieldOf(
    const Element& e, const V& length, const Vec& spin, const V (&v)[n]) {
  const Vec turn = e.R * e.axis.AngleRates(v);
  const V lengthening = length * e.axis.StretchRate(v), scale = length * e.axis.stretch;
  const Vec d0 = e.R.n0, B = e.B(), lw = scale * spin, lv = scale * turn;
  const V dot = Dot(e.th, lv), tau = e.axis.beta.x;
  return {Cross(lw, d0) + lengthening * d0, Cross(lw, e.A) + Cross(lv, d0) + lengthening * e.A,
          Cross(lw, B) + tau * lv + Dot(d0, lv) * e.th - (T(2) * dot) * d0 + lengthening * B,
          dot * e.A, dot * B};
}

template <typename T, int W>
template <typename L>
[[gnu::always_inline]] inline typename WoundStep<T, W>::V WoundStep<T, W>::Advance(
    const V& dt, const T* constants, const L& loads, const Element& e, Vec& velocity, Vec& spin,
    const T* state, T* new_state) {
  V v[n], turned{};
  for (int i = 0; i < n; ++i) v[i] = e.z[i] - Dot(e.Z1[i], velocity) - Dot(e.Z2[i], spin);
  e.L.Backward(v);
  for (int i = 0; i < n; ++i) turned += dt * dt * v[i] * v[i];
  const auto far = turned > T(kLargestTurn * kLargestTurn);
  if (simd::MANE_ISA::Any(far)) {
    const V scale = far ? T(kLargestTurn) / simd::MANE_ISA::Sqrt(turned) : All(1);
    for (int i = 0; i < n; ++i) v[i] *= scale;
  }
  // A bead turns about the axis.
  const V length = Row(constants, layout::kLength);
  const Field along = FieldOf(e, length, spin, v);
  const Vec turn = e.R * e.axis.AngleRates(v);
  const Vec once = Cross(e.th, turn), twice = Cross(e.th, once);
  V sum{};
#pragma GCC unroll 4
  for (int g = 0; g < kBeads; ++g) {
    const V s = All(kBeadRule.nodes[g]), phi2 = e.phi2[g], phi3 = e.phi3[g];
    const Vec here = spin + s * turn + phi2 * once + phi3 * twice;
    const Vec u_theta = velocity + along.At(s, {phi2, phi3, e.psi2[g], e.psi3[g]}) +
                        length * Cross(here, e.bead[g]);
    const Vec u = Rows(state, layout::kBeadVelocities + 3 * g);
    Vec next = u + All(1 / kTheta) * (u_theta - u);
    loads.Stop(next);
    Put(next, new_state, layout::kBeadVelocities + 3 * g);
    sum += next.x + next.y + next.z;
  }
  loads.Show(along, velocity);
  for (int i = 0; i < n; ++i) {
    const V x = Row(state, layout::kUnknowns + i) + dt * v[i];
    Put(v[i], new_state, layout::kUnknownRates + i);
    Put(x, new_state, layout::kUnknowns + i);
    sum += x;
  }
  spin += turn + e.c2 * once + e.c3 * twice;
  velocity += along.At(All(1), EndShape(e));
  return sum;
}

template <typename T, int W>
template <typename LoadsOf>
[[gnu::always_inline]] inline void WoundStep<T, W>::SolveWith(
    int N, const Clamp& clamp, const Constants& step, const T* constants, const T* drive,
    const T* state, const LoadsOf& loads_of, Element* scratch, T* next, T* size, T* turning) {
  constexpr int kConstants = layout::kConstantsPerWoundElement * layout::kLanes;
  constexpr int kState = layout::kStatePerWoundElement * layout::kLanes;
  const T* const own = constants + layout::kFirstElement * layout::kLanes;
  CostToGo beyond{};
  for (int Q = N - 1; Q >= 0; --Q) {
    Element& e = scratch[Q];
    const T* const element = own + Q * kConstants;
    const V length = Row(element, layout::kLength);
    const Turns turns(e);
    RateCost rates{};
    CostToGo left{};
    AddInertia(step, length, state + Q * kState, e, turns, rates, left);
    AddElasticity(step, element, state + Q * kState, rates);
    loads_of(Q).Add(length, e, rates, left);
    const V stretch = e.axis.stretch;
    const Vec end = stretch * (e.R.n0 + e.c2 * e.A + e.c3 * e.B());
    const Vec centre = stretch * (All(0.5) * e.R.n0 + e.c3 * e.A + e.c4 * e.B());
    left.arm = length * (beyond.mass * end + length * centre);
    left.mass = beyond.mass + length;
    AddWeight(step, e.spin, All(0.5) * (left.arm + beyond.arm), beyond);
    AddBeyond(length, e, turns, beyond, rates, left);
    loads_of(Q).Steady(left);
    Eliminate(rates, e, left);
    beyond = left;
  }

  const V dt = Row(drive, layout::kDuration);
  Vec velocity = clamp.velocity, spin = clamp.spin;
  V sum{}, largest{};
  Turning turned(clamp);
  for (int Q = 0; Q < N; ++Q) {
    const T* const element = own + Q * kConstants;
    sum += Advance(dt, element, loads_of(Q), scratch[Q], velocity, spin, state + Q * kState,
                   next + Q * kState);
    if (turning != nullptr) {
      const Element& e = scratch[Q];
      const V length = e.axis.stretch * Row(element, layout::kLength);
      turned.Add(velocity - All(kTheta) * e.led, spin - All(kTheta) * e.spin,
                 length * (e.R.n0 + e.c2 * e.A + e.c3 * e.B()));
    }
    V square{};
    for (int i = 0; i < n; ++i) {
      const V x = Row(next + Q * kState, layout::kUnknowns + i);
      square += x * x;
    }
    largest = square > largest ? square : largest;
  }
  const auto finite = (sum < T(1e30)) & (sum > T(-1e30));
  simd::MANE_ISA::Store(finite ? largest : All(1e30), size);
  if (turning == nullptr) return;
  const V half = T(0.5) * Row(constants, layout::kUnit);
  simd::MANE_ISA::Store(half * simd::MANE_ISA::Sqrt(turned.most), turning);
}

template <typename T, int W>
void WoundStep<T, W>::Step(int N, const T* constants, const T* drive, T* state, Element* scratch,
                           T* size) {
  const Clamp clamp = AxisClamp(constants, drive);
  const Constants step = Prepare(constants, drive, clamp.velocity);
  Linearise(N, clamp, step.h, constants + layout::kFirstElement * layout::kLanes, state, scratch);
  SolveWith(
      N, clamp, step, constants, drive, state, [](int) { return NoLoads{}; }, scratch, state, size,
      nullptr);
}

}  // namespace MANE_ISA
}  // namespace mane::rod
