#pragma once

/// Where segments of wisps are closest (contact.md, H1 to H3), lane by lane; only for sources that
/// define MANE_ISA.

#include "contact/wisp_layout.h"
#include "simd/lanewise.h"

namespace mane::contact {
namespace MANE_ISA {

/// Geometry of lanes V of segments.
template <typename V>
struct Segments {
  using Vec = simd::MANE_ISA::Vector<V>;

  struct Segment {
    Vec a, b;
  };
  /// Where two segments are closest, by their fractions.
  struct Fractions {
    V s, t;
  };

  static V Least(const V& x, const V& y) { return x < y ? x : y; }
  static V Most(const V& x, const V& y) { return x > y ? x : y; }
  static V Unit(const V& x) { return Least(Most(x, V{}), V{} + 1); }

  /// ClosestPoints (test_segments.h), without branches.
  static Fractions Closest(const Segment& p, const Segment& q) {
    constexpr float kParallel = 1e-3F, kPoint = 1e-14F;  // As there.
    const V one = V{} + 1;
    const Vec d = p.b - p.a, e = q.b - q.a, r = p.a - q.a;
    const V dd = Dot(d, d), ee = Dot(e, e), de = Dot(d, e), dr = Dot(d, r), er = Dot(e, r);
    const auto first_is_point = dd <= kPoint, second_is_point = ee <= kPoint;
    const V over_d = one / (first_is_point ? one : dd), over_e = one / (second_is_point ? one : ee);
    // Nearest to the second's ends.
    const V to_a = first_is_point ? V{} : Unit(-dr * over_d);
    const V to_b = first_is_point ? V{} : Unit((de - dr) * over_d);
    const V regular = kParallel * dd * ee, middle = 0.5F * (to_a + to_b);
    const V across = Most(dd * ee - de * de, V{}) + regular;
    const V inside = Unit((de * er - dr * ee + regular * middle) / Most(across, V{} + 1e-37F));
    V s = first_is_point ? V{} : inside;
    const V t = (de * s + er) * over_e;
    s = t < 0.0F ? to_a : t > 1.0F ? to_b : s;
    return {second_is_point ? to_a : s, second_is_point ? V{} : Unit(t)};
  }

  static Vec Apart(const Segment& p, const Segment& q, const Fractions& at) {
    return p.a + at.s * (p.b - p.a) - q.a - at.t * (q.b - q.a);
  }
};

/// Two segments a lane.
template <int W>
class SegmentPairs : simd::MANE_ISA::Lanewise<float, W> {
  using Base = simd::MANE_ISA::Lanewise<float, W>;
  using Base::Put;
  using Base::Row;
  using Base::Rows;
  using typename Base::V;
  using typename Base::Vec;
  using Geometry = Segments<V>;
  using Segment = typename Geometry::Segment;
  using Fractions = typename Geometry::Fractions;

 public:
  static void Approach(const float* in, float dt, float* out) {
    const V reach = Row(in, kTouchAt);
    const Segment p = At(in, kEnds), q = At(in, kEnds + 6);
    const Segment u = At(in, kMotion), w = At(in, kMotion + 6);
    Fractions at = Geometry::Closest(p, q);
    Vec d = Geometry::Apart(p, q, at), speed = Geometry::Apart(u, w, at);
    V time = TouchTime(d, speed, reach, dt);
    // Other places may be closest then.
    const auto moves = time * time * Dot(speed, speed) > 0.01F * reach * reach;
    if (simd::MANE_ISA::Any(moves)) {
      const Fractions then = Geometry::Closest({p.a + time * u.a, p.b + time * u.b},
                                               {q.a + time * w.a, q.b + time * w.b});
      at = {moves ? then.s : at.s, moves ? then.t : at.t};
      d = Geometry::Apart(p, q, at);
      speed = Geometry::Apart(u, w, at);
      time = TouchTime(d, speed, reach, dt);
    }
    const Vec nearest = d + NearestTime(d, speed, dt) * speed;
    Put(at.s, out, kFractions);
    Put(at.t, out, kFractions + 1);
    Put(simd::MANE_ISA::Sqrt(Dot(nearest, nearest)), out, kLeastApart);
    Put(d, out, kApart);
    Put(d + time * speed, out, kTouching);
  }

  static void Lines(const float* in, float* out) {
    const Segment p = At(in, kEnds), q = At(in, kEnds + 6);
    const Segment u = At(in, kMotion), w = At(in, kMotion + 6);
    const Vec d = Geometry::Apart(p, q, Geometry::Closest(p, q));
    const V distance = simd::MANE_ISA::Sqrt(Dot(d, d));
    // No line is between the planes across the connection: only what ends move along it brings
    // them nearer.
    const Vec n = ((V{} + 1) / Geometry::Most(distance, V{} + 1e-9F)) * d;
    const V nearing =
        Geometry::Most(Dot(w.a, n), Dot(w.b, n)) - Geometry::Least(Dot(u.a, n), Dot(u.b, n));
    Put(distance, out, kLinesApart);
    Put(Geometry::Most(nearing, V{}), out, kLinesNearing);
  }

 private:
  static Segment At(const float* in, int row) { return {Rows(in, row), Rows(in, row + 3)}; }

  // When d + time w is shortest in [0, dt].
  static V NearestTime(const Vec& d, const Vec& w, float dt) {
    const V part = -Dot(d, w) / Geometry::Most(Dot(w, w), V{} + 1e-20F);
    return Geometry::Least(Geometry::Most(part, V{}), V{} + dt);
  }

  // First time in [0, dt] at which d + time w is as short as `reach`, or shortest.
  static V TouchTime(const Vec& d, const Vec& w, const V& reach, float dt) {
    const V ww = Dot(w, w), dw = Dot(d, w), beyond = Dot(d, d) - reach * reach;
    const V root = dw * dw - ww * beyond;
    const auto touches = root > 0.0F;
    const V divisor = touches ? simd::MANE_ISA::Sqrt(touches ? root : V{}) - dw : ww;
    const V time = (touches ? beyond : -dw) / Geometry::Most(divisor, V{} + 1e-30F);
    const auto comes = (beyond > 0.0F) & (dw < 0.0F) & (ww * (dt * dt) > 1e-14F);
    return comes ? Geometry::Least(time, V{} + dt) : V{};
  }
};

/// Two links: a segment of the second a lane, those of the first in turn.
class LinkPairs {
  static constexpr int W = kLongestLink;
  using V = simd::MANE_ISA::Lanes<float, W>;
  using Geometry = Segments<V>;
  using Vec = Geometry::Vec;
  using Segment = Geometry::Segment;

 public:
  static NearestSegments Closest(const LinkPoints& a, const LinkPoints& b) {
    const Segment other = All(b.place, b.count);
    const Vec other_middle = other.a + other.b;
    const V far = Beyond(b.count);
    V squared[kLongestLink];  // Of the distances of middles, or more.
    V least = V{} + kFar;
    for (int i = 0; i < a.count; ++i) {
      const Segment mine = One(a.place, i);
      const Vec twice = mine.a + mine.b - other_middle;
      squared[i] = 0.25F * Dot(twice, twice) + far;
      least = Geometry::Least(least, squared[i]);
    }
    // Segments are no farther apart than their middles, and no nearer than those less their halves.
    const float within = __builtin_sqrtf(Horizontal(least)) + a.half + b.half;
    V best = V{} + kFar, which{};
    for (int i = 0; i < a.count; ++i) {
      if (!simd::MANE_ISA::Any(squared[i] <= within * within)) continue;
      const Segment mine = One(a.place, i);
      const Vec d = Geometry::Apart(mine, other, Geometry::Closest(mine, other));
      Take(Dot(d, d) + far, i, &best, &which);
    }
    return Nearest(best, which);
  }

  static NearestSegments ClosestWithin(const LinkPoints& a, const LinkPoints& b) {
    const Segment other = All(b.place, b.count), other_sweep = All(b.sweep, b.count);
    const Vec other_middle = other.a + other.b, other_way = other_sweep.a + other_sweep.b;
    const V far = Beyond(b.count);
    V best = V{} + kFar, which{};
    for (int i = 0; i < a.count; ++i) {
      const Segment mine = One(a.place, i), my_sweep = One(a.sweep, i);
      const V half = V{} + 0.5F;
      const Vec d = half * (mine.a + mine.b - other_middle);
      const Vec way = half * (my_sweep.a + my_sweep.b - other_way);
      const V time = Geometry::Unit(-Dot(d, way) / Geometry::Most(Dot(way, way), V{} + 1e-20F));
      const Vec then = d + time * way;
      Take(Dot(then, then) + far, i, &best, &which);
    }
    return Nearest(best, which);
  }

 private:
  static constexpr float kFar = 1e30F;

  static Vec Point(const float* x) { return {V{} + x[0], V{} + x[1], V{} + x[2]}; }
  static Segment One(const float* points, int i) {
    return {Point(points + 3 * i), Point(points + 3 * i + 3)};
  }
  // Segment by segment; lanes past the last repeat it.
  static Segment All(const float* points, int count) {
    float ends[6][W];
    for (int lane = 0; lane < W; ++lane) {
      const float* const x = points + 3 * (lane < count ? lane : count - 1);
      for (int k = 0; k < 6; ++k) ends[k][lane] = x[k];
    }
    V rows[6];
    __builtin_memcpy(rows, ends, sizeof(rows));
    return {{rows[0], rows[1], rows[2]}, {rows[3], rows[4], rows[5]}};
  }
  // Large in lanes past the last.
  static V Beyond(int count) {
    float far[W];
    for (int lane = 0; lane < W; ++lane) far[lane] = lane < count ? 0 : kFar;
    V v;
    __builtin_memcpy(&v, far, sizeof(v));
    return v;
  }
  static void Take(const V& squared, int i, V* best, V* which) {
    const auto nearer = squared < *best;
    *best = nearer ? squared : *best;
    *which = nearer ? V{} + static_cast<float>(i) : *which;
  }
  static float Horizontal(const V& v) {
    float least = v[0];
    for (int lane = 1; lane < W; ++lane) least = v[lane] < least ? v[lane] : least;
    return least;
  }
  static NearestSegments Nearest(const V& best, const V& which) {
    int lane = 0;
    for (int k = 1; k < W; ++k) lane = best[k] < best[lane] ? k : lane;
    return {__builtin_sqrtf(best[lane]), {static_cast<int>(which[lane]), lane}};
  }
};

/// Whole rows, by groups of W lanes.
template <int W>
struct WispTable {
  static void Approach(const float* in, float dt, float* out) {
    for (int l = 0; l < simd::kLanes; l += W) SegmentPairs<W>::Approach(in + l, dt, out + l);
  }
  static void Lines(const float* in, float* out) {
    for (int l = 0; l < simd::kLanes; l += W) SegmentPairs<W>::Lines(in + l, out + l);
  }
  static constexpr WispKernels Make() {
    return {&Approach, &Lines, &LinkPairs::Closest, &LinkPairs::ClosestWithin};
  }
};

}  // namespace MANE_ISA
}  // namespace mane::contact
