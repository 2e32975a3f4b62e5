#pragma once

/// Moving hair and the hull (beam.md, B6 and B13); only for sources that define MANE_ISA.

#include "beam/directions.h"
#include "beam/motion_layout.h"

namespace mane::beam {
namespace MANE_ISA {

template <typename T, int W>
struct AtHull : Directions<T, W> {
  using Base = Directions<T, W>;
  using Base::Times;
  using Base::TransposeTimes;
  using typename Base::V;
  using typename Base::Vec;

  /// The hull of a head that moves, of points in world axes from the head's place.
  struct Ball {
    const layout::MotionStep<T>& step;
    Vec center;  // Of the hull, where it is the unit ball.

    [[gnu::always_inline]] Vec At(const Vec& p) const { return Times(step.to_hull, p) - center; }
    [[gnu::always_inline]] Vec Along(const Vec& v) const { return Times(step.to_hull, v); }
    [[gnu::always_inline]] Vec Slope(const Vec& y) const { return TransposeTimes(step.to_hull, y); }
  };

  /// F where a segment ends at y, pushed into the hull close by: epsilon F (B13).
  [[gnu::always_inline]] static void Weaken(const layout::MotionShape<T>& shape, const Ball& ball,
                                            const T& epsilon, const Vec& y, Vec& F) {
    const Vec g = ball.Slope(y);
    const V size = Base::Size(g);
    const auto close = Dot(y, y) - T(1) < shape.twice_near * size;
    const auto pushed = Dot(g, F) < shape.alpha * (size * Base::Size(F));
    F = ((close & pushed) ? V{} + epsilon : V{} + 1) * F;
  }

  /// `went`, of a segment along e that ends on the hull at `node`, without what of it goes into the
  /// hull, and not faster than `speed` (squared), both as seen from the head, with which it would
  /// go `rides`.
  [[gnu::always_inline]] static Vec Stopped(const Ball& ball, const Vec& node, const Vec& e,
                                            const Vec& rides, const V& speed, const Vec& went) {
    const Vec n = Base::Across(ball.Slope(ball.At(node)), e);
    const V square = Dot(n, n);
    Vec past = went - rides;
    const V into = Dot(past, n);
    const auto goes = (into < T(0)) & (square > Base::kNothing);
    past = Select(goes, past - (into / (goes ? square : V{} + 1)) * n, past);
    const V size = Dot(past, past);
    const auto faster = size > speed;
    return rides + (faster ? Sqrt(speed / (faster ? size : V{} + 1)) : V{} + 1) * past;
  }
};

}  // namespace MANE_ISA
}  // namespace mane::beam
