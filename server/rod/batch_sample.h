#pragma once

/// Points of a block of strands, one strand per lane; only for sources that define MANE_ISA.

#include "rod/batch_stumpff.h"

namespace mane::rod {
namespace MANE_ISA {

/// Strands whose centreline is a Super-Helix.
template <typename T, int W>
class StrandSample : StumpffOf<T, W> {
  using Base = StumpffOf<T, W>;
  using Base::All;
  using Base::FrameRows;
  using Base::Next;
  using Base::Put;
  using Base::Reduce;
  using Base::Row;
  using Base::Rows;
  using typename Base::V;
  using typename Base::Vec;

 public:
  /// Positions of `points` points at equal arc length, root and tip included, x, y, z of each lane
  /// in turn: (points x 3 x kLanes), world [m].
  static void Sample(int N, const T* constants, const T* pose, const T* state, int points,
                     T* positions);
};

template <typename T, int W>
void StrandSample<T, W>::Sample(int N, const T* constants, const T* pose, const T* state,
                                int points, T* positions) {
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
      const Stumpff<V> c = Base::template Evaluate<false>(reduction, s);
      const Vec r = left + (scale * s) * (R.n0 + (s * c.c2) * A + (s * s * c.c3) * B);
      T* const row = positions + 3 * j * layout::kLanes;
      Put(Select(inside, r, Rows(row, 0)), row, 0);
    }
    const Stumpff<V> c = Base::template Evaluate<false>(reduction, T(1));
    left += scale * (R.n0 + c.c2 * A + c.c3 * B);
    R = Next(R, q, c);
    begin = end;
    state += layout::kStatePerElement * layout::kLanes;
    own += layout::kConstantsPerElement * layout::kLanes;
  }
}

}  // namespace MANE_ISA
}  // namespace mane::rod
