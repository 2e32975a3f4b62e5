#pragma once

/// Statics, lane by lane (beam.md, B3 to B6); only for sources that define MANE_ISA.

#include "beam/bend_kernels.h"
#include "simd/lanewise.h"

namespace mane::beam {
namespace MANE_ISA {

/// W hairs. A segment takes some 60 flops, 30 more a force, and where any lane's node is inside the
/// hull 60 and 25 a halving; it writes its node and reads nothing but the force's rows, so that a
/// block stays in the nearest cache.
template <typename T, int W>
class Bending : simd::MANE_ISA::Lanewise<T, W> {
  using Base = simd::MANE_ISA::Lanewise<T, W>;
  using Base::All;
  using Base::Put;
  using Base::Row;
  using Base::Rows;
  using typename Base::V;
  using typename Base::Vec;

 public:
  static void Bend(int k, const T* weights, const BendScene<T>& scene, const T* hairs, T* nodes) {
    Vec p = Rows(hairs, bend_layout::kRoot), e = Rows(hairs, bend_layout::kDirection);
    const V d = Row(hairs, bend_layout::kLength), softness = Row(hairs, bend_layout::kSoftness);
    const Vec inverse = Broadcast(scene.inverse_radii);
    Put(p, nodes, 0);
    for (int i = 0; i < k; ++i) {
      const Vec a = Acceleration(scene, hairs, inverse, p);
      const V along = Dot(a, e);
      // Up to the direction of a, and not beyond (B5).
      const V limit = All(1) / Larger(along, All(kTiny)), full = weights[i] * softness;
      const V turn = full < limit ? full : limit;
      const Vec bent = Unit(e + turn * (a - along * e));
      e = KeepOut(inverse, p, d, e, bent);
      p += d * e;
      Put(p, nodes, 3 * (i + 1));
    }
  }

 private:
  static constexpr bool kIsFloat = sizeof(T) == 4;
  static constexpr double kTiny = 1e-30;
  // Squared sine below which directions count as parallel: their plane is lost in rounding.
  static constexpr double kParallel = kIsFloat ? 1e-10 : 1e-24;
  // Of the arc in which a direction leaves the hull, 90 degrees at first.
  static constexpr int kHalvings = kIsFloat ? 16 : 50;

  static V Larger(const V& a, const V& b) { return a > b ? a : b; }
  static Vec Broadcast(const T (&a)[3]) { return {All(a[0]), All(a[1]), All(a[2])}; }
  static Vec Unit(const Vec& a) {
    return (All(1) / simd::MANE_ISA::Sqrt(Larger(Dot(a, a), All(kTiny)))) * a;
  }
  static V Size(const Vec& a) { return simd::MANE_ISA::Sqrt(Dot(a, a)); }
  static Vec Across(const Vec& a, const Vec& unit) { return a - Dot(a, unit) * unit; }

  // In which what hangs at p hangs.
  [[gnu::always_inline]] static Vec Acceleration(const BendScene<T>& scene, const T* hairs,
                                                 const Vec& inverse, const Vec& p) {
    Vec a = Broadcast(scene.gravity);
    for (int f = 0; f < scene.force_count; ++f) {
      const BendForce<T>& force = scene.forces[f];
      V share = Row(hairs, bend_layout::kFirstForce + f);
      for (int j = 0; j < force.plane_count; ++j) {
        const T* n = force.planes + bend_layout::kPlaneNumbers * j;
        share = n[0] * p.x + n[1] * p.y + n[2] * p.z >= All(n[3]) ? share : V{};
      }
      if (force.kind == BendForce<T>::Kind::kUniform) {
        a += share * Broadcast(force.vector);
        continue;
      }
      Vec way = Broadcast(force.point) - p;
      const V distance = Larger(Size(way), All(force.softening));
      if (force.kind == BendForce<T>::Kind::kAround) {
        way = Across(way, Unit(Times(inverse, Times(inverse, p))));
      }
      a += (force.strength * share / distance) * way;
    }
    return a;
  }

  // E + 1 of the node in a direction.
  static V Level(const Vec& inverse, const Vec& p, const V& d, const Vec& e) {
    const Vec q = Times(inverse, p + d * e);
    return Dot(q, q);
  }

  // `bent`, or where its node is inside, the direction in its plane with `before` next to it whose
  // node is not (B6).
  [[gnu::always_inline]] static Vec KeepOut(const Vec& inverse, const Vec& p, const V& d,
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

template <typename T, int W>
void BendBlock(int segments, const T* weights, const BendScene<T>& scene, const T* hairs,
               T* nodes) {
  for (int lane = 0; lane < simd::kLanes; lane += W) {
    Bending<T, W>::Bend(segments, weights, scene, hairs + lane, nodes + lane);
  }
}

template <typename T, int W>
constexpr BendKernels<T> MakeBend() {
  return {&BendBlock<T, W>};
}

}  // namespace MANE_ISA
}  // namespace mane::beam
