#pragma once

/// Statics, lane by lane (beam.md, B3 to B6); only for sources that define MANE_ISA.

#include "beam/bend_kernels.h"
#include "beam/keep_out.h"

namespace mane::beam {
namespace MANE_ISA {

/// W hairs. A segment takes some 60 flops, 30 more a force, and where any lane's node is inside the
/// hull what KeepOut does; it writes its node and reads nothing but the force's rows, so that a
/// block stays in the nearest cache.
template <typename T, int W>
class Bending : Directions<T, W> {
  using Base = Directions<T, W>;
  using Out = KeepOut<T, W>;
  using Base::Across;
  using Base::All;
  using Base::Larger;
  using Base::Put;
  using Base::Row;
  using Base::Rows;
  using Base::Unit;
  using typename Base::V;
  using typename Base::Vec;

 public:
  static void Bend(int k, const T* weights, const BendScene<T>& scene, const T* hairs, T* nodes) {
    Vec p = Rows(hairs, bend_layout::kRoot), e = Rows(hairs, bend_layout::kDirection);
    const V d = Row(hairs, bend_layout::kLength), softness = Row(hairs, bend_layout::kSoftness);
    const Ball ball{All(scene.inverse_radii)};
    const V reach = All(1);
    Put(p, nodes, 0);
    for (int i = 0; i < k; ++i) {
      const Vec a = Acceleration(scene, hairs, ball, p);
      const V along = Dot(a, e);
      // Up to the direction of a, and not beyond (B5).
      const V limit = All(1) / Larger(along, All(Base::kTiny)), full = weights[i] * softness;
      const Vec bent = Unit(e + Base::Smaller(full, limit) * (a - along * e));
      const auto inside = Out::Level(ball, p + d * bent) < reach;
      e = Any(inside) ? Out::TurnedOut(ball, reach, inside, p, d, e, bent) : bent;
      p += d * e;
      Put(p, nodes, 3 * (i + 1));
    }
  }

 private:
  // The hull of a head at rest, of points from its center.
  struct Ball {
    Vec inverse;  // Of its radii [1/m].

    [[gnu::always_inline]] Vec At(const Vec& p) const { return simd::MANE_ISA::Times(inverse, p); }
    [[gnu::always_inline]] Vec Along(const Vec& v) const { return At(v); }
    [[gnu::always_inline]] Vec Slope(const Vec& y) const { return At(y); }
  };

  // In which what hangs at p hangs.
  [[gnu::always_inline]] static Vec Acceleration(const BendScene<T>& scene, const T* hairs,
                                                 const Ball& ball, const Vec& p) {
    Vec a = All(scene.gravity);
    for (int f = 0; f < scene.force_count; ++f) {
      const BendForce<T>& force = scene.forces[f];
      V share = Row(hairs, bend_layout::kFirstForce + f);
      for (int j = 0; j < force.plane_count; ++j) {
        const T* n = force.planes + bend_layout::kPlaneNumbers * j;
        share = n[0] * p.x + n[1] * p.y + n[2] * p.z >= All(n[3]) ? share : V{};
      }
      if (force.kind == BendForce<T>::Kind::kUniform) {
        a += share * All(force.vector);
        continue;
      }
      Vec way = All(force.point) - p;
      const V distance = Larger(Base::Size(way), All(force.softening));
      if (force.kind == BendForce<T>::Kind::kAround) {
        way = Across(way, Unit(ball.Slope(ball.At(p))));
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
