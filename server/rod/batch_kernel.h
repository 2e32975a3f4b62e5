#pragma once

/// The time step of step.h for a block of strands, one strand per lane. Only for the sources
/// batch_kernel_<isa>.cpp, which define MANE_ISA.
///
/// Letters are those of rod.md; vectors are in world components and in the units of batch_layout.h.
/// Nothing here may instantiate a template of the standard library: the linker would keep one copy
/// of it, perhaps one with instructions that another machine lacks.

#include "rod/batch_layout.h"
#include "rod/batch_vectors.h"

namespace mane::rod {
namespace MANE_ISA {

// Gauss-Legendre on [0, 1], as math::GaussLegendre(layout::kPoints).
inline constexpr double kNodes[layout::kPoints] = {0.069431844202973712, 0.33000947820757187,
                                                   0.66999052179242813, 0.93056815579702629};
inline constexpr double kWeights[layout::kPoints] = {0.17392742256872693, 0.32607257743127307,
                                                     0.32607257743127307, 0.17392742256872693};
inline constexpr double kTheta = 0.55;
inline constexpr double kLargestTurn = 1e3;
inline constexpr double kLeastFriction = 0.5;

/// Stumpff functions at many arguments reduced together: series up to kReduced, then doublings,
/// each lane as many as its own angle needs, so that no lane depends on its neighbours.
template <typename T, typename V>
struct Reduction {
  static constexpr double kReduced = 2.5;
  static constexpr int kMost = 40;  // Angles up to 1e12 rad.
  V zeta;                           // |theta|^2
  V z;                              // The same over 4^doublings.
  V doublings;                      // Of each lane.
  int most;                         // Of any lane.
};

template <typename V>
struct Stumpff {
  V c0, c1, c2, c3, c4, c5, c6;
};

template <typename T, int W>
class Kernel {
 public:
  using V = simd::MANE_ISA::Lanes<T, W>;
  using Vec = Vector<V>;

  /// What a step keeps of an element between its passes.
  struct Element {
    Frame<V> R;            // Left frame at the linearisation.
    Vec th, A;             // theta, theta x d0; B = theta x A = tau theta - zeta d0.
    Vec spin;              // Right end's extrapolated angular velocity.
    V tau, zeta;           // theta.d0, |theta|^2
    V c2, c3, c4, c5, c6;  // c_n(zeta)
    // At the Gauss points, for an element of length 1; phi1 is the node.
    V phi2[layout::kPoints], phi3[layout::kPoints], psi2[layout::kPoints], psi3[layout::kPoints];
    Lower<V> L;  // rates = L^-T (z - Z1 velocity - Z2 spin)
    Matrix<V> Z1, Z2;
    Vec z;

    [[nodiscard]] Vec B() const { return tau * th - zeta * R.n0; }
  };

  /// Advances W strands of N elements; all pointers at the first of their lanes. `scratch` has room
  /// for N elements. `size` gets the largest |theta|^2 of each strand, 1e30
  /// where its new state is not finite.
  static void Step(int N, const T* constants, const T* drive, T* state, Element* scratch, T* size);

  /// Positions of `points` points at equal arc length, root and tip included, x, y, z of each lane
  /// in turn: (points x 3 x kLanes), world [m].
  static void Sample(int N, const T* constants, const T* pose, const T* state, int points,
                     T* positions);

 private:
  // Momentum-velocity form beyond an element: 1/2 V.A V - b.V about its left end.
  struct CostToGo {
    Symmetric<V> A11, A22;
    Matrix<V> A12;
    Vec b1, b2;
    V mass;   // Of all of it,
    Vec arm;  // and its first moment about the left end of its first element.
  };
  // The part of an element's cost that has its rates v: 1/2 v.H v + v.(Hv1 velocity + Hv2 spin) -
  // g.v.
  struct RateCost {
    Symmetric<V> H;
    Matrix<V> Hv1, Hv2;
    Vec g;
  };
  // Constants of a step.
  struct Step_ {
    V h, inertia, friction;
    Vec body, stiffness;
    Vec pull;  // Direction of the weight and of the drag of passing air,
    V force;   // and h times their size.
  };

  static V Row(const T* base, int row) {
    return simd::MANE_ISA::Load<V>(base + row * layout::kLanes);
  }
  static Vec Rows(const T* base, int row) {
    return {Row(base, row), Row(base, row + 1), Row(base, row + 2)};
  }
  static void Put(const V& v, T* base, int row) {
    simd::MANE_ISA::Store(v, base + row * layout::kLanes);
  }
  static void Put(const Vec& v, T* base, int row) {
    Put(v.x, base, row), Put(v.y, base, row + 1), Put(v.z, base, row + 2);
  }
  static Frame<V> FrameRows(const T* base, int row) {
    return {Rows(base, row), Rows(base, row + 3), Rows(base, row + 6)};
  }
  static V All(double x) { return V{} + T(x); }

  static Reduction<T, V> Reduce(const V& zeta);
  // c_n(s^2 zeta), up to c5; with `six` also c6. `s` is one number or one per lane, in [0, 1].
  template <bool six, typename S>
  static Stumpff<V> Evaluate(const Reduction<T, V>& reduction, const S& s);
  template <bool six>
  static Stumpff<V> Series(const V& z);
  // c_n(z) by its power series, for z up to kReduced.
  template <int n>
  static V Power(const V& z);
  // The right frame of an element whose left one is R, by local angles (H2).
  static Frame<V> Next(const Frame<V>& R, const Vec& theta, const Stumpff<V>& c);

  static Step_ Prepare(const T* constants, const T* drive, const Vec& velocity);
  static void Linearise(int N, const Frame<V>& root, const V& h, const Vec& spin, const T* state,
                        Element* elements);
  static void AddInertia(const Step_& step, const V& length, const T* state, const Element& element,
                         RateCost& rates, CostToGo& left);
  static void AddElasticity(const Step_& step, const T* constants, const T* state,
                            const Element& element, RateCost& rates);
  static void AddWeight(const Step_& step, const Element& element, const Vec& arm,
                        CostToGo& beyond);
  template <bool tip>
  static void AddBeyond(const V& length, const Element& element, const CostToGo& beyond,
                        RateCost& rates, CostToGo& left);
  static void Eliminate(const RateCost& rates, Element& element, CostToGo& left);
  // Tip to root: one element's costs and those beyond it, without its rates. What only one of the
  // two ends needs is left out at the other.
  template <bool tip, bool root>
  static void GoThrough(const Step_& step, const T* constants, const T* state, Element& element,
                        CostToGo& beyond);
  static V Advance(const V& dt, const T* constants, Element& element, Vec& velocity, Vec& spin,
                   T* state);
};

template <typename T, int W>
[[gnu::always_inline]] inline Reduction<T, typename Kernel<T, W>::V> Kernel<T, W>::Reduce(
    const V& zeta) {
  Reduction<T, V> r{zeta, zeta, V{}, 0};
  for (auto large = r.z > T(r.kReduced); r.most < r.kMost && simd::MANE_ISA::Any(large);
       large = r.z > T(r.kReduced), ++r.most) {
    r.z = large ? r.z * T(0.25) : r.z;
    r.doublings = large ? r.doublings + T(1) : r.doublings;
  }
  return r;
}

// Coefficients (-1)^k / (n + 2k)! of c_n.
template <typename T, int n>
struct Coefficients {
  // The next term is below half a unit in the last place at kReduced.
  static constexpr int kTerms = sizeof(T) == 4 ? 5 : 10;
  T k[kTerms];
  constexpr Coefficients() : k() {
    double c = 1;
    for (int i = 2; i <= n; ++i) c /= i;
    for (int i = 0; i < kTerms; ++i) {
      k[i] = T(c);
      c /= -(n + 2 * i + 1.0) * (n + 2 * i + 2.0);
    }
  }
};

template <typename T, int W>
template <int n>
[[gnu::always_inline]] inline typename Kernel<T, W>::V Kernel<T, W>::Power(const V& z) {
  constexpr Coefficients<T, n> c;
  V sum = V{} + c.k[c.kTerms - 1];
  for (int i = c.kTerms - 2; i >= 0; --i) sum = sum * z + c.k[i];
  return sum;
}

template <typename T, int W>
template <bool six>
[[gnu::always_inline]] inline Stumpff<typename Kernel<T, W>::V> Kernel<T, W>::Series(const V& z) {
  Stumpff<V> c;
  if constexpr (six) {
    c.c6 = Power<6>(z);
    c.c4 = T(1.0 / 24) - z * c.c6;
  } else {
    c.c6 = V{};
    c.c4 = Power<4>(z);
  }
  c.c5 = Power<5>(z);
  c.c3 = T(1.0 / 6) - z * c.c5;
  c.c2 = T(0.5) - z * c.c4;
  c.c1 = T(1) - z * c.c3;
  c.c0 = T(1) - z * c.c2;
  return c;
}

template <typename T, int W>
template <bool six, typename S>
[[gnu::always_inline]] inline Stumpff<typename Kernel<T, W>::V> Kernel<T, W>::Evaluate(
    const Reduction<T, V>& reduction, const S& s) {
  const V whole = reduction.zeta * (s * s);
  if (reduction.most == 0) return Series<six>(whole);
  const auto wound = whole > T(reduction.kReduced);
  V z = wound ? reduction.z * (s * s) : whole;
  Stumpff<V> c = Series<six>(z);
  // Cosine and sine of the double angle, kept a pair of one: frames stay orthonormal and strands of
  // their length whatever the angle (rod.md, B2).
  for (int level = reduction.most; level > 0; --level) {
    const auto wanted = wound & (reduction.doublings >= T(level));
    const V sine2 = z * c.c1 * c.c1, scale = T(1.5) - T(0.5) * (c.c0 * c.c0 + sine2);
    const V scale2 = scale * scale;
    c.c1 = wanted ? scale2 * c.c0 * c.c1 : c.c1;
    c.c0 = wanted ? T(1) - T(2) * scale2 * sine2 : c.c0;
    z = wanted ? z * T(4) : z;
  }
  const V inverse = T(1) / (wound ? z : All(1));
  c.c2 = wound ? (T(1) - c.c0) * inverse : c.c2;
  c.c3 = wound ? (T(1) - c.c1) * inverse : c.c3;
  c.c4 = wound ? (T(0.5) - c.c2) * inverse : c.c4;
  c.c5 = wound ? (T(1.0 / 6) - c.c3) * inverse : c.c5;
  if constexpr (six) c.c6 = wound ? (T(1.0 / 24) - c.c4) * inverse : c.c6;
  return c;
}

template <typename T, int W>
[[gnu::always_inline]] inline Frame<typename Kernel<T, W>::V> Kernel<T, W>::Next(
    const Frame<V>& R, const Vec& q, const Stumpff<V>& c) {
  const Vec q1 = c.c1 * q, q2 = c.c2 * q;
  const V xy = q2.x * q.y, xz = q2.x * q.z, yz = q2.y * q.z;
  // Columns of exp [q] = c0 + c1 [q] + c2 q q^T.
  const Vec e0{c.c0 + q2.x * q.x, xy + q1.z, xz - q1.y};
  const Vec e1{xy - q1.z, c.c0 + q2.y * q.y, yz + q1.x};
  const Vec e2{xz + q1.y, yz - q1.x, c.c0 + q2.z * q.z};
  return {R * e0, R * e1, R * e2};
}

template <typename T, int W>
typename Kernel<T, W>::Step_ Kernel<T, W>::Prepare(const T* constants, const T* drive,
                                                   const Vec& velocity) {
  const V h = T(kTheta) * Row(drive, layout::kDuration);
  const V drag = Row(drive, layout::kDragScale) * Row(constants, layout::kDrag);
  const Vec weight = Rows(drive, layout::kGravity) + drag * Rows(drive, layout::kWind);
  const Vec body = (h * Row(constants, layout::kInverseUnit)) * weight;
  const Vec pull = body - (h * drag) * velocity;
  const V size = simd::MANE_ISA::Sqrt(Dot(pull, pull) + T(1e-30));
  return {h,
          T(1) + h * drag,
          h * Row(drive, layout::kFrictionScale) * Row(constants, layout::kFriction),
          body,
          Rows(constants, layout::kStiffness),
          (T(1) / size) * pull,
          h * size};
}

// Root to tip: frames and shapes at the extrapolated angles.
template <typename T, int W>
void Kernel<T, W>::Linearise(int N, const Frame<V>& root, const V& h, const Vec& spin,
                             const T* state, Element* elements) {
  Frame<V> R = root;
  Vec omega = spin;
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
#pragma GCC unroll 4
    for (int g = 0; g < layout::kPoints; ++g) {
      const T s = T(kNodes[g]);
      const Stumpff<V> c = Evaluate<false>(reduction, s);
      e.phi2[g] = (s * s) * c.c2;
      e.phi3[g] = (s * s * s) * c.c3;
      e.psi2[g] = (s * s * s * s) * (T(2) * c.c4 - c.c3);
      e.psi3[g] = (s * s * s * s * s) * (T(3) * c.c5 - c.c4);
    }
    const Stumpff<V> c = Evaluate<true>(reduction, T(1));
    e.c2 = c.c2, e.c3 = c.c3, e.c4 = c.c4, e.c5 = c.c5, e.c6 = c.c6;
    const Vec v = R * rate, turn = Cross(e.th, v);
    omega += v + c.c2 * turn + c.c3 * Cross(e.th, turn);
    e.spin = omega;
    R = Next(R, q, c);
  }
}

// Sums over the Gauss points of (1/2 M |velocity + spin x r + J v|^2 - m u.(the same)). J and r are
// combinations of d0, theta and A whose coefficients are numbers, so that these need to be summed,
// not the matrices (rod.md, B3).
template <typename T, int W>
[[gnu::always_inline]] inline void Kernel<T, W>::AddInertia(const Step_& step, const V& length,
                                                            const T* state, const Element& e,
                                                            RateCost& rates, CostToGo& left) {
  V s2{}, s3{}, t2{}, t3{};                              // <phi>, <psi>
  V m12{}, m13{}, m22{}, m23{}, m33{};                   // <phi phi>
  V n12{}, n13{}, n22{}, n33{}, n32_23{}, o22{}, o33{};  // <phi psi>, <psi psi>
  // <u>, <phi u>, <psi u>. Weight acts as momentum evenly spread over the length, whose sums are
  // integrals that are known exactly (H7, H8).
  Vec U0 = step.body, U1 = All(0.5) * U0, U2 = e.c3 * U0, U3 = e.c4 * U0;
  Vec V2 = (T(3) * e.c5 - e.c4) * U0, V3 = (T(4) * e.c6 - e.c5) * U0;
#pragma GCC unroll 4
  for (int g = 0; g < layout::kPoints; ++g) {
    const T s = T(kNodes[g]), w = T(kWeights[g]);
    const V phi2 = e.phi2[g], phi3 = e.phi3[g], psi2 = e.psi2[g], psi3 = e.psi3[g];
    const V w2 = w * phi2, w3 = w * phi3, x2 = w * psi2, x3 = w * psi3;
    s2 += w2, s3 += w3, t2 += x2, t3 += x3;
    m12 += s * w2, m13 += s * w3, n12 += s * x2, n13 += s * x3;
    m22 += w2 * phi2, m23 += w2 * phi3, m33 += w3 * phi3;
    n22 += w2 * psi2, n33 += w3 * psi3, n32_23 += w3 * psi2 - w2 * psi3;
    o22 += x2 * psi2, o33 += x3 * psi3;
    const Vec u = Rows(state, layout::kVelocities + 3 * g);
    const Vec wu = All(w) * u;
    U0 += wu, U1 += All(s) * wu;
    U2 += w2 * u, U3 += w3 * u, V2 += x2 * u, V3 += x3 * u;
  }
  const Vec d0 = e.R.n0, th = e.th, A = e.A, B = e.B();
  const V tau = e.tau, zeta = e.zeta, beta = zeta - tau * tau;  // beta = |A|^2

  // Momentum: J^T u, u and r x u.
  const V length2 = length * length;
  rates.g += length2 * (Cross(d0, U2) + tau * U3 + Dot(th, U3) * d0 +
                        (Dot(A, V2) + Dot(B, V3) - T(2) * Dot(d0, U3)) * th);
  left.b1 += length * U0;
  left.b2 += length2 * (Cross(d0, U1) + Cross(A, U2) + Cross(B, U3));

  // Inertia. From here on the sums are those of an element of its own length and mass.
  const V I0 = length * step.inertia, I1 = length * I0, I2 = length * I1;
  s2 *= I1, s3 *= I1, t2 *= I1, t3 *= I1;
  const V s1 = T(0.5) * I1, m11 = T(1.0 / 3) * I2;
  m12 *= I2, m13 *= I2, m22 *= I2, m23 *= I2, m33 *= I2;
  n12 *= I2, n13 *= I2, n22 *= I2, n33 *= I2, n32_23 *= I2, o22 *= I2, o33 *= I2;
  const V tau_m23 = tau * m23, tau_m33 = tau * m33, zeta_m33 = zeta * m33;

  // J^T J.
  const V both =
      T(2) * (n22 + (tau * tau + T(2) * beta) * n33) + T(4) * m33 + beta * (o22 + zeta * o33);
  const V diagonal = m22 + tau * tau_m33;
  rates.H.xx += diagonal, rates.H.yy += diagonal, rates.H.zz += diagonal;
  AddTwice(
      rates.H, d0,
      (T(0.5) * (zeta_m33 - m22)) * d0 - (tau * (T(3) * m33 + n22 + zeta * n33)) * th - m23 * A);
  AddTwice(rates.H, th, (T(0.5) * both) * th + (tau * n32_23) * A);

  // J^T.
  const Vec s3th = s3 * th;
  const Vec C = t2 * A + (t3 * tau) * th - (t3 * zeta + T(2) * s3) * d0;
  AddCrossMatrix(rates.Hv1, s2 * d0, s3 * tau);
  AddOuter(rates.Hv1, d0, s3th);
  AddOuter(rates.Hv1, th, C);

  // -J^T [r].
  const V m13_33 = m13 - zeta_m33, twice = T(2) * m23 + n12;
  const Vec w = -tau * (m13_33 * d0 + m23 * A + tau_m33 * th);
  AddCrossMatrix(rates.Hv2, w, m12 - beta * m23);
  AddOuter(rates.Hv2, d0, (T(2) * zeta * m23 - m12) * d0 - tau_m23 * th - m13_33 * A);
  AddOuter(rates.Hv2, A, -m22 * d0);
  AddOuter(
      rates.Hv2, th,
      (twice - beta * n32_23) * th - (tau * (m23 + twice)) * d0 - (T(2) * tau_m33 + tau * n13) * A);

  // The whole element turning and moving as a rigid body.
  left.A11.xx += I0, left.A11.yy += I0, left.A11.zz += I0;
  left.A12 -= CrossMatrix(s1 * d0 + s2 * A + s3 * B);
  Symmetric<V> second{};  // r r^T
  AddTwice(
      second, d0,
      (T(0.5) * (m11 - zeta * (m13 + m13_33))) * d0 + (m12 - zeta * m23) * A + (tau * m13_33) * th);
  AddTwice(second, A, (T(0.5) * m22) * A + tau_m23 * th);
  AddOuter(second, (tau * tau_m33) * th, th);
  AddInertiaOf(left.A22, second);
}

template <typename T, int W>
[[gnu::always_inline]] inline void Kernel<T, W>::AddElasticity(const Step_& step,
                                                               const T* constants, const T* state,
                                                               const Element& e, RateCost& rates) {
  const V inverse = Row(constants, layout::kInverseLength);
  const Vec hk = (step.h * inverse) * step.stiffness;
  const Vec force = Times(hk, Rows(state, layout::kAngles) - Rows(constants, layout::kNatural));
  const V friction = step.friction * inverse;
  const auto damped = [&](const V& k) {
    const V least = T(kLeastFriction) * k;
    return k + (friction > least ? friction : least);
  };
  const Vec stiff = step.h * hk;
  const Vec k{damped(stiff.x), damped(stiff.y), damped(stiff.z)};
  rates.g -= e.R * force;
  // sum k_i n_i n_i^T, of which k_1 n_1 n_1^T = k_1 (1 - n_0 n_0^T - n_2 n_2^T).
  const V even = k.y;
  rates.H.xx += even, rates.H.yy += even, rates.H.zz += even;
  AddOuter(rates.H, (k.x - k.y) * e.R.n0, e.R.n0);
  AddOuter(rates.H, (k.z - k.y) * e.R.n2, e.R.n2);
}

// The turning stiffness of weight at the right end (S9).
template <typename T, int W>
[[gnu::always_inline]] inline void Kernel<T, W>::AddWeight(const Step_& step, const Element& e,
                                                           const Vec& arm, CostToGo& beyond) {
  const V length2 = Dot(arm, arm) + T(1e-30);
  const V length = simd::MANE_ISA::Sqrt(length2);
  const Vec b = (T(1) / length) * arm, across = step.pull - b, along = step.pull + b;
  const V cosine = Dot(step.pull, b), size = step.force * length;
  const V down = cosine > T(0) ? cosine : V{}, up = cosine > T(0) ? V{} : cosine;
  const V diagonal = size * down;
  Symmetric<V> G{diagonal, V{}, V{}, diagonal, V{}, diagonal};
  AddOuter(G, (-diagonal / (T(2) + T(2) * down)) * along, along);
  AddOuter(G, (size * (T(1) + up) / (T(4) - T(4) * up)) * across, across);
  beyond.A22 += G;
  beyond.b2 += G * e.spin;
}

// What lies beyond the right end, whose twist is X (velocity; spin) + S v (S6).
template <typename T, int W>
template <bool tip>
[[gnu::always_inline]] inline void Kernel<T, W>::AddBeyond(const V& length, const Element& e,
                                                           const CostToGo& beyond, RateCost& rates,
                                                           CostToGo& left) {
  const Vec d0 = e.R.n0, th = e.th;
  const V tau = e.tau;
  // S = (J; T), column by column (H5, H6).
  const Vec a = e.c2 * th, b = e.c3 * th;
  const V turn = T(1) - e.zeta * e.c3;
  Vec S[3] = {th.x * b, th.y * b, th.z * b};
  S[0].x += turn, S[0].y += a.z, S[0].z -= a.y;
  S[1].x -= a.z, S[1].y += turn, S[1].z += a.x;
  S[2].x += a.y, S[2].y -= a.x, S[2].z += turn;
  if constexpr (tip) {  // Nothing but the tip's own weight, which only turns.
    const Vec Q[3] = {beyond.A22 * S[0], beyond.A22 * S[1], beyond.A22 * S[2]};
    rates.Hv2.x += Q[0], rates.Hv2.y += Q[1], rates.Hv2.z += Q[2];
    rates.g += Vec{Dot(S[0], beyond.b2), Dot(S[1], beyond.b2), Dot(S[2], beyond.b2)};
    rates.H.xx += Dot(S[0], Q[0]), rates.H.xy += Dot(S[0], Q[1]), rates.H.xz += Dot(S[0], Q[2]);
    rates.H.yy += Dot(S[1], Q[1]), rates.H.yz += Dot(S[1], Q[2]), rates.H.zz += Dot(S[2], Q[2]);
    left.A22 += beyond.A22;
    left.b2 += beyond.b2;
    return;
  }
  const V phi2 = length * e.c2, phi3 = length * e.c3;
  const V psi2 = length * (T(2) * e.c4 - e.c3), psi3 = length * (T(3) * e.c5 - e.c4);
  const Vec d = (length - e.zeta * phi3) * d0 + phi2 * e.A + (tau * phi3) * th;
  const Vec C = psi2 * e.A + (psi3 * tau) * th - (psi3 * e.zeta + T(2) * phi3) * d0;
  const Vec f = phi3 * d0, p = phi2 * d0;
  const V diagonal = phi3 * tau;
  Vec J[3] = {f.x * th + th.x * C, f.y * th + th.y * C, f.z * th + th.z * C};
  J[0].x += diagonal, J[0].y -= p.z, J[0].z += p.y;
  J[1].x += p.z, J[1].y += diagonal, J[1].z -= p.x;
  J[2].x -= p.y, J[2].y += p.x, J[2].z += diagonal;

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

  // X^T A X with X = (1, -[d]; 0, 1).
  const Matrix<V> Y = beyond.A12 - TimesCross(beyond.A11, d);
  left.A11 += beyond.A11;
  left.A12 += Y;
  left.A22 += beyond.A22;
  AddCongruence(left.A22, beyond.A12, Y, d);
  left.b1 += beyond.b1;
  left.b2 += beyond.b2 + Cross(d, beyond.b1);
}

// The rates by the left end's twist, and the cost of that alone (S7).
template <typename T, int W>
[[gnu::always_inline]] inline void Kernel<T, W>::Eliminate(const RateCost& rates, Element& e,
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
[[gnu::always_inline]] inline typename Kernel<T, W>::V Kernel<T, W>::Advance(
    const V& dt, const T* constants, Element& e, Vec& velocity, Vec& spin, T* state) {
  const Vec d0 = e.R.n0;
  Vec v = e.L.Backward(e.z - e.Z1 * velocity - e.Z2 * spin);
  const V turned = dt * dt * Dot(v, v);
  const auto far = turned > T(kLargestTurn * kLargestTurn);
  if (simd::MANE_ISA::Any(far)) {
    const V scale = T(kLargestTurn) / simd::MANE_ISA::Sqrt(turned);
    v = (far ? scale : All(1)) * v;
  }
  // The field is velocity + phi1 X1 + phi2 X2 + phi3 X3 + psi2 Y2 + psi3 Y3.
  const V length = Row(constants, layout::kLength);
  const Vec lw = length * spin, lv = length * v, B = e.B();
  const V dot = Dot(e.th, lv);
  const Vec X1 = Cross(lw, d0);
  const Vec X2 = Cross(lw, e.A) + Cross(lv, d0);
  const Vec X3 = Cross(lw, B) + e.tau * lv + Dot(d0, lv) * e.th - (T(2) * dot) * d0;
  const Vec Y2 = dot * e.A, Y3 = dot * B;
  V sum{};
#pragma GCC unroll 4
  for (int g = 0; g < layout::kPoints; ++g) {
    const Vec u_theta = velocity + All(kNodes[g]) * X1 + e.phi2[g] * X2 + e.phi3[g] * X3 +
                        e.psi2[g] * Y2 + e.psi3[g] * Y3;
    const Vec u = Rows(state, layout::kVelocities + 3 * g);
    const Vec next = u + All(1 / kTheta) * (u_theta - u);
    Put(next, state, layout::kVelocities + 3 * g);
    sum += next.x + next.y + next.z;
  }
  const Vec rate = TransposeTimes(e.R, v);
  const Vec q = Rows(state, layout::kAngles) + dt * rate;
  Put(rate, state, layout::kRates);
  Put(q, state, layout::kAngles);
  velocity += X1 + e.c2 * X2 + e.c3 * X3 + (T(2) * e.c4 - e.c3) * Y2 + (T(3) * e.c5 - e.c4) * Y3;
  const Vec turn = Cross(e.th, v);
  spin += v + e.c2 * turn + e.c3 * Cross(e.th, turn);
  return sum + (q.x + q.y + q.z);
}

template <typename T, int W>
template <bool tip, bool root>
[[gnu::always_inline]] inline void Kernel<T, W>::GoThrough(const Step_& step, const T* constants,
                                                           const T* state, Element& e,
                                                           CostToGo& beyond) {
  const V length = Row(constants, layout::kLength);
  RateCost rates{};
  CostToGo left{};
  AddInertia(step, length, state, e, rates, left);
  AddElasticity(step, constants, state, e, rates);
  const Vec B = e.B(), end = e.R.n0 + e.c2 * e.A + e.c3 * B;
  const Vec centre = All(0.5) * e.R.n0 + e.c3 * e.A + e.c4 * B;
  if constexpr (tip) beyond = CostToGo{};
  left.arm = length * (beyond.mass * end + length * centre);
  left.mass = beyond.mass + length;
  AddWeight(step, e, All(0.5) * (left.arm + beyond.arm), beyond);
  AddBeyond<tip>(length, e, beyond, rates, left);
  Eliminate(rates, e, left);
  if constexpr (!root) beyond = left;
}

template <typename T, int W>
void Kernel<T, W>::Step(int N, const T* constants, const T* drive, T* state, Element* scratch,
                        T* size) {
  const V inverse_unit = Row(constants, layout::kInverseUnit);
  Vec velocity =
      inverse_unit * (Rows(drive, layout::kHeadVelocity) +
                      FrameRows(drive, layout::kSpread) * Rows(constants, layout::kRootPosition));
  Vec spin = Rows(drive, layout::kSpin);
  const Step_ step = Prepare(constants, drive, velocity);
  const Frame<V> middle = FrameRows(drive, layout::kMiddleFrame);
  const Frame<V> root = FrameRows(constants, layout::kRootFrame);
  Linearise(N, {middle * root.n0, middle * root.n1, middle * root.n2}, step.h, spin, state,
            scratch);

  constexpr int kConstants = layout::kConstantsPerElement * layout::kLanes;
  constexpr int kState = layout::kStatePerElement * layout::kLanes;
  const T* element_constants = constants + layout::kFirstElement * layout::kLanes;
  CostToGo beyond{};
  const auto go = [&]<bool tip, bool root>(int Q) __attribute__((always_inline)) {
    GoThrough<tip, root>(step, element_constants + Q * kConstants, state + Q * kState, scratch[Q],
                         beyond);
  };
  if (N == 1) {
    go.template operator()<true, true>(0);
  } else {
    go.template operator()<true, false>(N - 1);
    for (int Q = N - 2; Q > 0; --Q) go.template operator()<false, false>(Q);
    go.template operator()<false, true>(0);
  }

  const V dt = Row(drive, layout::kDuration);
  V sum{}, largest{};
  for (int Q = 0; Q < N; ++Q) {
    sum += Advance(dt, element_constants + Q * kConstants, scratch[Q], velocity, spin,
                   state + Q * kState);
    const Vec q = Rows(state + Q * kState, layout::kAngles);
    const V square = Dot(q, q);
    largest = square > largest ? square : largest;
  }
  const auto finite = (sum < T(1e30)) & (sum > T(-1e30));
  simd::MANE_ISA::Store(finite ? largest : All(1e30), size);
}

template <typename T, int W>
void Kernel<T, W>::Sample(int N, const T* constants, const T* pose, const T* state, int points,
                          T* positions) {
  const Frame<V> head = FrameRows(pose, layout::kPoseFrame);
  const Frame<V> root = FrameRows(constants, layout::kRootFrame);
  const V unit = Row(constants, layout::kUnit);
  Frame<V> R{head * root.n0, head * root.n1, head * root.n2};
  Vec left = Rows(pose, layout::kPosePosition) + head * Rows(constants, layout::kRootPosition);
  V begin{};  // Arc length of the left end.
  const T spacing = T(N) / T(points - 1);
  const T* own = constants + layout::kFirstElement * layout::kLanes;
  int first = 0;  // Points before it lie in earlier elements of every lane.
  for (int Q = 0; Q < N; ++Q) {
    const Vec q = Rows(state, layout::kAngles);
    const V length = Row(own, layout::kLength), inverse = Row(own, layout::kInverseLength);
    const V end = begin + length, scale = unit * length;
    const Vec th = R * q, A = Cross(th, R.n0), B = Cross(th, A);
    const Reduction<T, V> reduction = Reduce(Dot(q, q));
    // Inside: from the left end, exclusive unless it is the root, to the right end.
    for (int j = first; j < points; ++j) {
      const T sigma = spacing * T(j);
      if (Q < N - 1 && !simd::MANE_ISA::Any(end >= sigma)) break;
      if (Q < N - 1 && !simd::MANE_ISA::Any(end < sigma)) first = j + 1;
      const auto inside = (begin < sigma) | (begin <= T(0));
      V s = (sigma - begin) * inverse;
      s = s < T(1) ? s : All(1);
      s = s > T(0) ? s : V{};
      const Stumpff<V> c = Evaluate<false>(reduction, s);
      const Vec r = left + (scale * s) * (R.n0 + (s * c.c2) * A + (s * s * c.c3) * B);
      T* const row = positions + 3 * j * layout::kLanes;
      Put(Select(inside, r, Rows(row, 0)), row, 0);
    }
    const Stumpff<V> c = Evaluate<false>(reduction, T(1));
    left += scale * (R.n0 + c.c2 * A + c.c3 * B);
    R = Next(R, q, c);
    begin = end;
    state += layout::kStatePerElement * layout::kLanes;
    own += layout::kConstantsPerElement * layout::kLanes;
  }
}

}  // namespace MANE_ISA
}  // namespace mane::rod
