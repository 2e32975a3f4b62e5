#pragma once

/// The batched steps among loads (rod.md, S13, S14): Approach says where points of the strands are
/// when they are linearised, Solve advances them with what presses and rubs there. Only for sources
/// that define MANE_ISA.

#include "rod/batch_inertia.h"
#include "rod/batch_step.h"
#include "rod/batch_wound_step.h"

namespace mane::rod {
namespace MANE_ISA {

// Super-Helices.

template <typename T, int W>
struct StrandStep<T, W>::Loads : ElementLoads {
  using ElementLoads::At;
  using ElementLoads::count;
  using ElementLoads::FractionOf;
  using ElementLoads::loaded;
  using ElementLoads::shapes;

  void Add(const V& length, const Element& e, RateCost& rates, CostToGo& left) const {
    for (int k = 0; k < count; ++k) {
      if (loaded[k] == 0) continue;
      const PointLoad load = At(k);
      Vec J[3], P[3], d;
      PointColumns(e, length, FractionOf(k), shapes[k], d, J);
      for (int i = 0; i < 3; ++i) P[i] = load.Times(J[i]);
      rates.Hv1.x += P[0], rates.Hv1.y += P[1], rates.Hv1.z += P[2];
      rates.Hv2.x += Cross(d, P[0]), rates.Hv2.y += Cross(d, P[1]), rates.Hv2.z += Cross(d, P[2]);
      rates.g += Vec{Dot(J[0], load.push), Dot(J[1], load.push), Dot(J[2], load.push)};
      rates.H.xx += Dot(J[0], P[0]), rates.H.xy += Dot(J[0], P[1]), rates.H.xz += Dot(J[0], P[2]);
      rates.H.yy += Dot(J[1], P[1]), rates.H.yz += Dot(J[1], P[2]), rates.H.zz += Dot(J[2], P[2]);
      Base::AddLoad(load, d, left);
    }
  }
};

template <typename T, int W>
void StrandStep<T, W>::Approach(int N, const int* first_point, const T* constants, const T* drive,
                                const T* state, Element* scratch, PointShape* shapes, T* points) {
  const Clamp clamp = ReadClamp(constants, drive);
  const V h = T(kTheta) * Row(drive, layout::kDuration), unit = Row(constants, layout::kUnit);
  Linearise(N, clamp, h, state, scratch);
  const T* element_constants = constants + layout::kFirstElement * layout::kLanes;
  Vec left = Base::FrameRows(drive, layout::kMiddleFrame) * Rows(constants, layout::kRootPosition);
  Vec velocity = clamp.velocity, spin = clamp.spin;
  for (int Q = 0; Q < N; ++Q) {
    Element& e = scratch[Q];
    const V length = Row(element_constants, layout::kLength), size = unit * length;
    const Vec v = e.R * Rows(state, layout::kRates), B = e.B();
    const Field along = FieldOf(e, length, spin, v);
    const auto reduction = Reduce(e.zeta);
    const int count = first_point[Q + 1] - first_point[Q];
    for (int k = 0; k < count; ++k, ++shapes) {
      const T s = T(k + 1) / T(count);
      V phi1;  // s c1
      if (k + 1 == count) {
        *shapes = EndShape(e);
        phi1 = T(1) - e.zeta * e.c3;
      } else {
        const Stumpff<V> c = Base::template Evaluate<false>(reduction, s);
        *shapes = Base::ShapeAt(s, c);
        phi1 = s * c.c1;
      }
      const Vec r = All(s) * e.R.n0 + shapes->phi2 * e.A + shapes->phi3 * B;
      Put(left + size * r, points, layout::kPosition);
      Put(e.R.n0 + phi1 * e.A + shapes->phi2 * B, points, layout::kTangent);
      Put(unit * (velocity + along.At(All(1) * s, *shapes)), points, layout::kLastVelocity);
      points += layout::kPointRows * layout::kLanes;
    }
    left += size * (e.R.n0 + e.c2 * e.A + e.c3 * B);
    velocity += along.At(All(1), EndShape(e));
    e.led = velocity;
    spin += EndTurn(e.th, v, e.c2, e.c3);
    element_constants += layout::kConstantsPerElement * layout::kLanes;
    state += layout::kStatePerElement * layout::kLanes;
  }
}

template <typename T, int W>
void StrandStep<T, W>::Solve(int N, const int* first_point, const T* constants, const T* drive,
                             const T* state, const T* loads, const unsigned char* loaded,
                             const unsigned char* watched, Element* scratch,
                             const PointShape* shapes, T* next, T* velocities, T* size,
                             T* turning) {
  const Clamp clamp = ReadClamp(constants, drive);
  const Constants step = Prepare(constants, drive, clamp.velocity);
  const V unit = Row(constants, layout::kUnit), inverse = Row(constants, layout::kInverseUnit);
  const ElementLoads all{first_point[N], loads, loaded, watched, shapes, velocities, unit, inverse};
  const auto loads_of = [&](int Q) __attribute__((always_inline)) {
    return Loads{all.Of(first_point[Q], first_point[Q + 1])};
  };
  SolveWith(N, clamp, step, constants, drive, state, loads_of, scratch, next, size, turning);
}

// Wound strands: points of the axis.

template <typename T, int W>
struct WoundStep<T, W>::Loads : ElementLoads {
  using ElementLoads::At;
  using ElementLoads::count;
  using ElementLoads::FractionOf;
  using ElementLoads::loaded;
  using ElementLoads::shapes;

  void Add(const V& length, const Element& e, RateCost& rates, CostToGo& left) const {
    for (int k = 0; k < count; ++k) {
      if (loaded[k] == 0) continue;
      const PointLoad load = At(k);
      const PointShape& shape = shapes[k];
      const Vec p = All(FractionOf(k)) * e.R.n0 + shape.phi2 * e.A + shape.phi3 * e.B();
      Columns J = AxisColumns(e, p, shape.phi2, shape.phi3, shape.psi2, shape.psi3);
      const Vec d = (length * e.axis.stretch) * p;
      for (int i = 0; i < n; ++i) {
        J.J[i] = length * J.J[i];
        const Vec P = load.Times(J.J[i]);
        rates.Hv1[i] += P;
        rates.Hv2[i] += Cross(d, P);
        rates.g[i] += Dot(J.J[i], load.push);
        for (int j = 0; j <= i; ++j) rates.H[i][j] += Dot(J.J[j], P);
      }
      Base::AddLoad(load, d, left);
    }
  }
};

template <typename T, int W>
void WoundStep<T, W>::Approach(int N, const int* first_point, const T* constants, const T* drive,
                               const T* state, Element* scratch, PointShape* shapes, T* points) {
  const Clamp clamp = AxisClamp(constants, drive);
  const V h = T(kTheta) * Row(drive, layout::kDuration), unit = Row(constants, layout::kUnit);
  const T* own = constants + layout::kFirstElement * layout::kLanes;
  Linearise(N, clamp, h, own, state, scratch);
  Vec left = Base::FrameRows(drive, layout::kMiddleFrame) * Rows(constants, layout::kRootPosition) +
             (unit * Row(own, layout::kRadius)) * clamp.root.n2;
  Vec velocity = clamp.velocity, spin = clamp.spin;
  for (int Q = 0; Q < N; ++Q) {
    Element& e = scratch[Q];
    const V length = Row(own, layout::kLength), size = unit * length * e.axis.stretch;
    V v[n];
    for (int i = 0; i < n; ++i) v[i] = Row(state, layout::kUnknownRates + i);
    const Vec turn = e.R * e.axis.AngleRates(v), B = e.B();
    const Field along = FieldOf(e, length, spin, v);
    const auto reduction = Reduce(e.zeta);
    const int count = first_point[Q + 1] - first_point[Q];
    for (int k = 0; k < count; ++k, ++shapes) {
      const T s = T(k + 1) / T(count);
      V phi1;  // s c1
      if (k + 1 == count) {
        *shapes = EndShape(e);
        phi1 = T(1) - e.zeta * e.c3;
      } else {
        const Stumpff<V> c = Base::template Evaluate<false>(reduction, s);
        *shapes = Base::ShapeAt(s, c);
        phi1 = s * c.c1;
      }
      const Vec r = All(s) * e.R.n0 + shapes->phi2 * e.A + shapes->phi3 * B;
      Put(left + size * r, points, layout::kPosition);
      Put(e.R.n0 + phi1 * e.A + shapes->phi2 * B, points, layout::kTangent);
      Put(unit * (velocity + along.At(All(1) * s, *shapes)), points, layout::kLastVelocity);
      points += layout::kPointRows * layout::kLanes;
    }
    left += size * (e.R.n0 + e.c2 * e.A + e.c3 * B);
    velocity += along.At(All(1), EndShape(e));
    e.led = velocity;
    spin += EndTurn(e.th, turn, e.c2, e.c3);
    own += layout::kConstantsPerWoundElement * layout::kLanes;
    state += layout::kStatePerWoundElement * layout::kLanes;
  }
}

template <typename T, int W>
void WoundStep<T, W>::Solve(int N, const int* first_point, const T* constants, const T* drive,
                            const T* state, const T* loads, const unsigned char* loaded,
                            const unsigned char* watched, Element* scratch,
                            const PointShape* shapes, T* next, T* velocities, T* size, T* turning) {
  const Clamp clamp = AxisClamp(constants, drive);
  const Constants step = Prepare(constants, drive, clamp.velocity);
  const V unit = Row(constants, layout::kUnit), inverse = Row(constants, layout::kInverseUnit);
  const ElementLoads all{first_point[N], loads, loaded, watched, shapes, velocities, unit, inverse};
  const auto loads_of = [&](int Q) __attribute__((always_inline)) {
    return Loads{all.Of(first_point[Q], first_point[Q + 1])};
  };
  SolveWith(N, clamp, step, constants, drive, state, loads_of, scratch, next, size, turning);
}

}  // namespace MANE_ISA
}  // namespace mane::rod
