#pragma once

/// How nodes are kept out of a hull, lane by lane (beam.md, B6); only for sources that define
/// MANE_ISA.

#include "simd/lanewise.h"

namespace mane::beam {
namespace MANE_ISA {

/// What bending and collision share of directions.
template <typename T, int W>
class KeepOut : protected simd::MANE_ISA::Lanewise<T, W> {
  using Base = simd::MANE_ISA::Lanewise<T, W>;

 protected:
  using Base::All;
  using typename Base::V;
  using typename Base::Vec;

 public:
  /// `bent`, or where its node is inside, the direction in its plane with `before` next to it whose
  /// node is not (B6).
  ///
  /// @param inverse  of the hull's radii [1/m].
  /// @param p        where the segment begins, from the hull's center, outside it [m].
  /// @param d        length of the segment [m].
  [[gnu::always_inline]] static Vec Turned(const Vec& inverse, const Vec& p, const V& d,
                                           const Vec& before, const Vec& bent) {
    const auto inside = Level(inverse, p, d, bent) < All(1);
    if (!simd::MANE_ISA::Any(inside)) return bent;
    const Vec gradient = Unit(Times(inverse, Times(inverse, p)));
    const Vec side = Side(before, bent, gradient);
    // In the plane: outward as far as it has an outward, and along the hull on the side of `bent`.
    const V along = Dot(gradient, bent), up = Dot(gradient, side), none{};
    const V size = simd::MANE_ISA::Sqrt(along * along + up * up);
    const auto has_outward = size > All(kIsFloat ? 1e-5 : 1e-12);
    const V scale = All(1) / Larger(size, All(kTiny)), sinking = along < none ? -along : along;
    const Vec outward = scale * (along * bent + up * side);
    const Vec level =
        scale * ((up < none ? -up : up) * bent + (up < none ? -sinking : sinking) * side);
    const auto level_is_out = has_outward & (Level(inverse, p, d, level) >= All(1));
    const auto outward_is_out = has_outward & (Level(inverse, p, d, outward) >= All(1));
    // What is outside but for rounding is replaced by what is despite rounding.
    Vec out = Select(level_is_out, level, Select(outward_is_out, outward, gradient));
    Vec in = Select(level_is_out, bent, Select(has_outward, level, bent));
    for (int i = 0; i < kHalvings; ++i) {
      const Vec middle = Unit(out + in);
      const auto is_out = Level(inverse, p, d, middle) >= All(1);
      out = Select(is_out, middle, out);
      in = Select(is_out, in, middle);
    }
    return Select(inside, out, bent);
  }

 protected:
  static constexpr double kTiny = 1e-30;
  static V Larger(const V& a, const V& b) { return a > b ? a : b; }
  static Vec Unit(const Vec& a) {
    return (All(1) / simd::MANE_ISA::Sqrt(Larger(Dot(a, a), All(kTiny)))) * a;
  }
  static V Size(const Vec& a) { return simd::MANE_ISA::Sqrt(Dot(a, a)); }
  static Vec Across(const Vec& a, const Vec& unit) { return a - Dot(a, unit) * unit; }

 private:
  static constexpr bool kIsFloat = sizeof(T) == 4;
  // Squared sine below which directions count as parallel: their plane is lost in rounding.
  static constexpr double kParallel = kIsFloat ? 1e-10 : 1e-24;
  // Of the arc in which a direction leaves the hull, 90 degrees at first.
  static constexpr int kHalvings = kIsFloat ? 16 : 50;

  // E + 1 of the node in a direction.
  static V Level(const Vec& inverse, const Vec& p, const V& d, const Vec& e) {
    const Vec q = Times(inverse, p + d * e);
    return Dot(q, q);
  }

  // Across `bent` toward `before`; toward the normal where those are parallel, and anywhere where
  // all three are.
  static Vec Side(const Vec& before, const Vec& bent, const Vec& normal) {
    const Vec turned = Across(before, bent), up = Across(normal, bent);
    const V none{};
    const auto steep = bent.y * bent.y > All(0.9);
    const Vec any = Select(steep, Vec{none, bent.z, -bent.y}, Vec{bent.z, none, -bent.x});
    const Vec side = Select(Dot(turned, turned) > All(kParallel), turned,
                            Select(Dot(up, up) > All(kParallel), up, any));
    // Rounding leaves some of `bent` in what was nearly parallel.
    return Unit(Across(Unit(side), bent));
  }
};

}  // namespace MANE_ISA
}  // namespace mane::beam
