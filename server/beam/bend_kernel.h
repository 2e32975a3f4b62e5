#pragma once

/// Statics, lane by lane (beam.md, B3 to B6); only for sources that define MANE_ISA.

#include "beam/bend_kernels.h"
#include "beam/keep_out.h"

namespace mane::beam {
namespace MANE_ISA {

/// W hairs. A segment takes some 60 flops, 30 more a force, and where any lane's node is inside the
/// hull 60 and 25 a halving; it writes its node and reads nothing but the force's rows, so that a
/// block stays in the nearest cache.
template <typename T, int W>
class Bending : KeepOut<T, W> {
  using Base = KeepOut<T, W>;
  using Base::Across;
  using Base::All;
  using Base::kTiny;
  using Base::Larger;
  using Base::Put;
  using Base::Row;
  using Base::Rows;
  using Base::Size;
  using Base::Turned;
  using Base::Unit;
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
      e = Turned(inverse, p, d, e, bent);
      p += d * e;
      Put(p, nodes, 3 * (i + 1));
    }
  }

 private:
  static Vec Broadcast(const T (&a)[3]) { return {All(a[0]), All(a[1]), All(a[2])}; }

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
