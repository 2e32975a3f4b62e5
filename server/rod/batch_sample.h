#pragma once

/// Points of a block of strands, one strand per lane; only for sources that define MANE_ISA.

#include "rod/batch_wound_axis.h"

namespace mane::rod {
namespace MANE_ISA {

/// A walk along strands whose centreline is a Super-Helix.
template <typename T, int W>
struct HelixWalk : StumpffOf<T, W> {
  using typename StumpffOf<T, W>::V;
  using typename StumpffOf<T, W>::Vec;
  static constexpr int kConstants = layout::kConstantsPerElement;
  static constexpr int kState = layout::kStatePerElement;

  Frame<V> R;  ///< Of the element's left end.
  Vec q, A, B;
  Reduction<T, V> reduction;

  /// Takes up the next element.
  void Enter(const T* /*constants*/, const T* state) {
    q = Lanewise<T, W>::Rows(state, layout::kAngles);
    const Vec th = R * q;
    A = Cross(th, R.n0);
    B = Cross(th, A);
    reduction = this->Reduce(Dot(q, q));
  }
  /// Point at the fraction s of the element, from its left end. [element lengths]
  [[nodiscard]] Vec At(const V& s) const {
    const Stumpff<V> c = this->template Evaluate<false>(reduction, s);
    return s * (R.n0 + (s * c.c2) * A + (s * s * c.c3) * B);
  }
  /// Goes to its right end.
  void Leave() { R = this->Next(R, q, this->template Evaluate<false>(reduction, T(1))); }
};

/// A walk along wound strands: along their axes, with the hair around them (coil.md, C9).
template <typename T, int W>
struct CoilWalk : WoundAxis<T, W> {
  using typename WoundAxis<T, W>::Axis;
  using typename WoundAxis<T, W>::V;
  using typename WoundAxis<T, W>::Vec;
  using Lanewise<T, W>::All;
  using Lanewise<T, W>::Row;
  static constexpr int kConstants = layout::kConstantsPerWoundElement;
  static constexpr int kState = layout::kStatePerWoundElement;

  /// One of the three turnings that the hair off the axis is a sum of: the integral of
  /// Re((a + i b) e^(i (phase + rate s))).
  struct Turning {
    V half;  // rate / 2
    Reduction<T, V> reduction;
    Vec a, b;
  };

  Frame<V> R;  ///< Of the axis at the element's left end.
  Axis axis;
  Vec A, B;
  Reduction<T, V> reduction;
  V cosine, sine;  ///< Of the left end's phase.
  Turning turnings[3];

  void Enter(const T* constants, const T* state) {
    V x[4];
    for (int i = 0; i < 4; ++i) x[i] = Row(state, layout::kUnknowns + i);
    axis = this->AxisOf(constants, x);
    const Vec beta = axis.beta, th = R * beta;
    A = Cross(th, R.n0);
    B = Cross(th, A);
    const V square = Dot(beta, beta);
    reduction = this->Reduce(square);
    cosine = Row(constants, layout::kPhaseCosine);
    sine = Row(constants, layout::kPhaseSine);

    // The parts of v = slant (0, 1, -i) along the turning axis of the element, m, and those across
    // it, which turn by -+|beta| s. Where beta = 0, m = 0 will do: the rates are the same then.
    const V bend = simd::MANE_ISA::Sqrt(square + T(1e-30)), slant = axis.slant;
    const Vec m = (T(1) / bend) * beta;
    const Vec along_a = m.y * m, along_b = -m.z * m;
    const Vec across_a = Vec{V{}, All(1), V{}} - along_a,
              across_b = Vec{V{}, V{}, All(-1)} - along_b;
    const Vec turned_a{m.y, -m.x, V{}}, turned_b{-m.z, V{}, m.x};
    const V rate = Row(constants, layout::kWinding), part = T(0.5) * slant;
    Set(0, rate, slant * along_a, slant * along_b);
    Set(1, rate + bend, part * (across_a - turned_a), part * (across_b - turned_b));
    Set(2, rate - bend, part * (across_a + turned_a), part * (across_b + turned_b));
  }
  [[nodiscard]] Vec At(const V& s) const {
    const Stumpff<V> c = this->template Evaluate<false>(reduction, s);
    Vec point = (axis.stretch * s) * (R.n0 + (s * c.c2) * A + (s * s * c.c3) * B);
    for (const Turning& t : turnings) {
      // s sinc(h) (a cos(phase + h) - b sin(phase + h)), h = rate s / 2.
      const Stumpff<V> h = this->template Evaluate<false>(t.reduction, s);
      const V turn = t.half * s * h.c1, size = s * h.c1;
      const V real = size * (cosine * h.c0 - sine * turn),
              imaginary = size * (sine * h.c0 + cosine * turn);
      point += real * t.a - imaginary * t.b;
    }
    return point;
  }
  void Leave() { R = this->Next(R, axis.beta, this->template Evaluate<false>(reduction, T(1))); }

 private:
  void Set(int i, const V& rate, const Vec& a, const Vec& b) {
    const V half = T(0.5) * rate;
    // In world components: the parts are those of the axis frame at the left end.
    turnings[i] = {half, this->Reduce(half * half), R * a, R * b};
  }
};

/// Positions of `points` points at equal arc length, root and tip included, x, y, z of each lane in
/// turn: (points x 3 x kLanes), world [m].
template <typename T, int W, typename Walk>
void Sample(int N, const T* constants, const T* pose, const T* state, int points, T* positions) {
  using L = Lanewise<T, W>;
  using V = typename L::V;
  using Vec = typename L::Vec;
  const Frame<V> head = L::FrameRows(pose, layout::kPoseFrame);
  const Frame<V> root = L::FrameRows(constants, layout::kRootFrame);
  const V unit = L::Row(constants, layout::kUnit);
  Walk walk;
  walk.R = {head * root.n0, head * root.n1, head * root.n2};
  Vec left =
      L::Rows(pose, layout::kPosePosition) + head * L::Rows(constants, layout::kRootPosition);
  V begin{};  // Arc length of the left end.
  const T spacing = T(N) / T(points - 1);
  const T* own = constants + layout::kFirstElement * layout::kLanes;
  int first = 0;  // Points before it lie in earlier elements of every lane.
  for (int Q = 0; Q < N; ++Q) {
    const V length = L::Row(own, layout::kLength), inverse = L::Row(own, layout::kInverseLength);
    const V end = begin + length, scale = unit * length;
    walk.Enter(own, state);
    // Inside: from the left end, exclusive unless it is the root, to the right end.
    for (int j = first; j < points; ++j) {
      const T sigma = spacing * T(j);
      if (Q < N - 1 && !simd::MANE_ISA::Any(end >= sigma)) break;
      if (Q < N - 1 && !simd::MANE_ISA::Any(end < sigma)) first = j + 1;
      const auto inside = (begin < sigma) | (begin <= T(0));
      V s = (sigma - begin) * inverse;
      s = s < T(1) ? s : L::All(1);
      s = s > T(0) ? s : V{};
      const Vec r = left + scale * walk.At(s);
      T* const row = positions + 3 * j * layout::kLanes;
      L::Put(Select(inside, r, L::Rows(row, 0)), row, 0);
    }
    left += scale * walk.At(L::All(1));
    walk.Leave();
    begin = end;
    state += Walk::kState * layout::kLanes;
    own += Walk::kConstants * layout::kLanes;
  }
}

}  // namespace MANE_ISA
}  // namespace mane::rod
