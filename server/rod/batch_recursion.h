#pragma once

/// What the batched steps of all kinds of strand share (rod.md, S5 to S9), lane by lane; only for
/// sources that define MANE_ISA. Letters are those of rod.md; vectors are in world components and
/// in the units of batch_layout.h.

#include "rod/batch_stumpff.h"
#include "rod/scheme.h"

namespace mane::rod {
namespace MANE_ISA {

template <typename T, int W>
struct Recursion : StumpffOf<T, W> {
  using typename StumpffOf<T, W>::V;
  using typename StumpffOf<T, W>::Vec;
  using Lanewise<T, W>::All;
  using Lanewise<T, W>::Row;
  using Lanewise<T, W>::Rows;
  using Lanewise<T, W>::FrameRows;
  using Lanewise<T, W>::Expect;
  using Lanewise<T, W>::Put;

  /// Constants of a step.
  struct Constants {
    V h, inertia, friction;
    Vec body;
    Vec pull;  ///< Direction of the weight and of the drag of passing air,
    V force;   ///< and h times their size.
  };

  /// Momentum-velocity form beyond an element: 1/2 V.A V - b.V about its left end.
  struct CostToGo {
    Symmetric<V> A11, A22;
    Matrix<V> A12;
    Vec b1, b2;
    V mass;   ///< Of all of it,
    Vec arm;  ///< and its first moment about the left end of its first element.
  };

  /// The clamp: velocity and spin of the root over the step, and its frame at kTheta of the way.
  struct Clamp {
    Frame<V> root;
    Vec velocity, spin;
  };

  [[gnu::always_inline]] static Clamp ReadClamp(const T* constants, const T* drive) {
    const Frame<V> middle = FrameRows(drive, layout::kMiddleFrame);
    const Frame<V> root = FrameRows(constants, layout::kRootFrame);
    return {
        {middle * root.n0, middle * root.n1, middle * root.n2},
        Row(constants, layout::kInverseUnit) *
            (Rows(drive, layout::kHeadVelocity) +
             FrameRows(drive, layout::kSpread) * Rows(constants, layout::kRootPosition)),
        Rows(drive, layout::kSpin),
    };
  }

  /// `velocity` is the root's.
  [[gnu::always_inline]] static Constants Prepare(const T* constants, const T* drive,
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
            (T(1) / size) * pull,
            h * size};
  }

  /// Adds the turning stiffness of weight at the right end of an element, whose extrapolated spin
  /// is `spin` (S9).
  [[gnu::always_inline]] static void AddWeight(const Constants& step, const Vec& spin,
                                               const Vec& arm, CostToGo& beyond) {
    const V length2 = Dot(arm, arm) + T(1e-30);
    const V length = simd::MANE_ISA::Sqrt(length2);
    const Vec b = (T(1) / length) * arm, across = step.pull - b, along = step.pull + b;
    const V cosine = Dot(step.pull, b), size = step.force * length;
    const V down = cosine > T(0) ? cosine : V{}, up = cosine - down;
    const V part = T(0.25) * size / (T(1) + down - up), diagonal = size * down;
    Symmetric<V> G{diagonal, V{}, V{}, diagonal, V{}, diagonal};
    AddOuter(G, (T(-2) * down * part) * along, along);
    AddOuter(G, ((T(1) + cosine) * part) * across, across);
    beyond.A22 += G;
    beyond.b2 += G * spin;
  }

  /// Adds a cost about a point that stands at `d` from where `left` is about: X^T A X and X^T b
  /// with X = (1, -[d]; 0, 1) (S6).
  [[gnu::always_inline]] static void AddShifted(const CostToGo& beyond, const Vec& d,
                                                CostToGo& left) {
    const Matrix<V> Y = beyond.A12 - TimesCross(beyond.A11, d);
    left.A11 += beyond.A11;
    left.A12 += Y;
    left.A22 += beyond.A22;
    AddCongruence(left.A22, beyond.A12, Y, d);
    left.b1 += beyond.b1;
    left.b2 += beyond.b2 + Cross(d, beyond.b1);
  }

  /// What presses and rubs at a point (S13).
  struct PointLoad {
    Vec normal;
    V hold, rest;  ///< W = hold 1 + rest n n^T
    Vec push;
    V press, surface_speed;

    PointLoad(const T* rows, const V& inverse_unit)
        : normal(Rows(rows, layout::kNormal)),
          hold(Row(rows, layout::kHold)),
          rest(Row(rows, layout::kPress) - hold),
          push(inverse_unit * (Rows(rows, layout::kPush) + Rows(rows, layout::kImpulse))),
          press(Row(rows, layout::kPress)),
          surface_speed(inverse_unit * Row(rows, layout::kSurfaceSpeed)) {}

    [[nodiscard]] Vec Times(const Vec& a) const {
      return hold * a + (rest * Dot(normal, a)) * normal;
    }
    /// Keeps `u` from leaving (S14).
    void Stop(Vec& u) const {
      const V over = Dot(normal, u) - surface_speed;
      u -= (((over > T(0)) & (press > T(0))) ? over : V{}) * normal;
    }
  };

  /// Adds a load at `d` from the left end, by the twist of that alone.
  [[gnu::always_inline]] static void AddLoad(const PointLoad& load, const Vec& d, CostToGo& left) {
    const Vec n = load.normal, m = Cross(d, n);
    left.A11.xx += load.hold, left.A11.yy += load.hold, left.A11.zz += load.hold;
    AddOuter(left.A11, load.rest * n, n);
    AddCrossMatrix(left.A12, -load.hold * d, V{});
    AddOuter(left.A12, load.rest * n, m);
    // hold [d]^T [d]; hold (d.d - d d^T) would take large numbers from each other, and leave less
    // of what turns about d than float32 can tell (S15).
    const Vec a = load.hold * d;
    left.A22.xx += a.y * d.y + a.z * d.z, left.A22.yy += a.x * d.x + a.z * d.z;
    left.A22.zz += a.x * d.x + a.y * d.y;
    left.A22.xy -= a.x * d.y, left.A22.xz -= a.x * d.z, left.A22.yz -= a.y * d.z;
    AddOuter(left.A22, load.rest * m, m);
    left.b1 += load.push;
    left.b2 += Cross(d, load.push);
  }

  /// c_n of a point at the fraction s of an element: phi2, phi3, psi2, psi3 of (H5), (H6).
  struct PointShape {
    V phi2, phi3, psi2, psi3;
  };
  [[gnu::always_inline]] static PointShape ShapeAt(const T& s, const Stumpff<V>& c) {
    const T s2 = s * s, s3 = s2 * s;
    return {s2 * c.c2, s3 * c.c3, (s2 * s2) * (T(2) * c.c4 - c.c3),
            (s2 * s3) * (T(3) * c.c5 - c.c4)};
  }

  /// Velocities along an element: at the fraction s, velocity + s X1 + phi2 X2 + phi3 X3 + psi2 Y2
  /// + psi3 Y3.
  struct Field {
    Vec X1, X2, X3, Y2, Y3;

    template <typename S>
    [[nodiscard, gnu::always_inline]] Vec At(const S& s, const PointShape& p) const {
      return s * X1 + p.phi2 * X2 + p.phi3 * X3 + p.psi2 * Y2 + p.psi3 * Y3;
    }
  };

  /// What a step does for points of its elements where there are none.
  struct NoLoads {
    template <typename... Step>
    void Add(const Step&... /*step*/) const {}
    void Steady(CostToGo& /*left*/) const {}
    void Stop(Vec& /*u*/) const {}
    void Show(const Field& /*along*/, const Vec& /*velocity*/) const {}
  };

  /// Loads on points of one element, or of all, at the fractions FractionOf(k); each kind of strand
  /// adds them to its own cost.
  struct ElementLoads {
    int count;                     ///< Of the points.
    const T* rows;                 ///< Of the element's points: loads,
    const unsigned char* loaded;   ///< whether any lane has one,
    const unsigned char* watched;  ///< and whether its velocity is wanted;
    const PointShape* shapes;      ///< shapes of the points,
    T* velocities;                 ///< and their velocities, out.
    V unit, inverse_unit;          ///< l0 and 1 / l0.

    /// Those of the element with the points from `first` up to `last`, where these are of all.
    [[nodiscard]] ElementLoads Of(int first, int last) const {
      return {last - first,   rows + first * layout::kLoadRows * layout::kLanes,
              loaded + first, watched + first,
              shapes + first, velocities + 3 * first * layout::kLanes,
              unit,           inverse_unit};
    }
    [[nodiscard]] T FractionOf(int k) const { return T(k + 1) / T(count); }
    [[nodiscard]] PointLoad At(int k) const {
      return {rows + k * layout::kLoadRows * layout::kLanes, inverse_unit};
    }
    /// Keeps the cost convex in rounded numbers (S15).
    void Steady(CostToGo& left) const {
      constexpr T kPart = sizeof(T) == 4 ? T(3e-7) : T(1e-15);
      const V mass = kPart * (left.A11.xx + left.A11.yy + left.A11.zz);
      const V inertia = kPart * (left.A22.xx + left.A22.yy + left.A22.zz);
      left.A11.xx += mass, left.A11.yy += mass, left.A11.zz += mass;
      left.A22.xx += inertia, left.A22.yy += inertia, left.A22.zz += inertia;
    }
    void Stop(Vec& u) const {
      for (int k = 0; k < count; ++k) {
        if (loaded[k] != 0) At(k).Stop(u);
      }
    }
    void Show(const Field& along, const Vec& velocity) const {
      for (int k = 0; k < count; ++k) {
        if (watched[k] == 0) continue;
        Put(unit * (velocity + along.At(All(FractionOf(k)), shapes[k])), velocities, 3 * k);
      }
    }
  };

  /// Stiffness k with the friction that it needs at least (S3, S10).
  [[gnu::always_inline]] static V Damped(const V& k, const V& friction) {
    const V least = T(kLeastFriction) * k;
    return k + (friction > least ? friction : least);
  }

  /// How the right ends of elements leave the straight lines of a step (S16), from root to tip.
  struct Turning {
    Vec velocity, spin;      // Of an element's left end over what led to the linearisation.
    Vec swings{}, leaves{};  // Twice the accelerations of its spin and of itself.
    V most{};                // Largest square of the latter.

    explicit Turning(const Clamp& clamp)
        : velocity(All(1 - kTheta) * clamp.velocity), spin(All(1 - kTheta) * clamp.spin) {}
    /// `chord` leads to the right end, which has the others.
    void Add(const Vec& right_velocity, const Vec& right_spin, const Vec& chord) {
      const Vec swung = Cross(spin, right_spin - spin);
      leaves += Cross(spin + right_spin, right_velocity - velocity) + Cross(swings + swung, chord);
      swings += All(2) * swung;
      velocity = right_velocity, spin = right_spin;
      const V square = Dot(leaves, leaves);
      most = square > most ? square : most;
    }
  };

  /// What the angles' rates v turn the right end by: T v, T = 1 + c2 [th] + c3 [th]^2 (H5).
  [[gnu::always_inline]] static Vec EndTurn(const Vec& th, const Vec& v, const V& c2, const V& c3) {
    const Vec turn = Cross(th, v);
    return v + c2 * turn + c3 * Cross(th, turn);
  }
};

}  // namespace MANE_ISA
}  // namespace mane::rod
