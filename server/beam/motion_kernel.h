#pragma once

/// Dynamics, lane by lane (beam.md, B7 to B15); only for sources that define MANE_ISA. Some 250
/// operations a segment; of memory, 11 rows read and 6 written.

#include "beam/keep_out.h"
#include "beam/motion_hull.h"
#include "beam/motion_kernels.h"
#include "beam/motion_polar.h"

namespace mane::beam {
namespace MANE_ISA {

/// Hairs whose segments are given by direction and step, Equations::kAcross.
template <typename T, int W>
struct AcrossSegment : Turns<T, W> {
  using Base = Turns<T, W>;
  using Base::Put;
  using Base::Rows;
  using typename Base::V;
  using typename Base::Vec;
  static constexpr int kRows = layout::kAcrossState;

  Vec e, delta;

  [[gnu::always_inline]] AcrossSegment(const T* state, const T& carried)
      : e(Rows(state, layout::kDirection)), delta((V{} + carried) * Rows(state, layout::kStep)) {}

  [[gnu::always_inline]] static Vec Direction(const T* state) {
    return Rows(state, layout::kDirection);
  }
  [[gnu::always_inline]] Vec Step(const Load<V>& load, const Vec& F) {
    const V square = Dot(F, F), x = load.bound * Sqrt(square);
    const V inverse = T(1) / (T(1) + load.drag + load.friction + x);
    const V kept = T(1) + Base::Momentum(x, Sqrt(Dot(delta, delta)));
    delta = inverse * (kept * delta + load.push * Base::Across(F, e) +
                       load.friction * Cross(load.head_step, e));
    Vec turned = e;
    Base::Turn(turned, delta);
    return turned;
  }
  [[gnu::always_inline]] Vec LastStep() const { return delta; }
  [[gnu::always_inline]] void Fluctuate(const Vec& from, const Vec& to) {
    delta = Base::Carried(delta, from, to);
  }
  template <typename M>
  [[gnu::always_inline]] void Correct(const M& moved, const Vec& /*to*/, const Vec& step) {
    delta = Select(moved, step, delta);
  }
  /// What is kept of a direction that it was put to.
  [[gnu::always_inline]] Vec Kept(const Vec& to) const { return to; }
  [[gnu::always_inline]] void Write(const Vec& to, T* state) const {
    Put(to, state, layout::kDirection), Put(delta, state, layout::kStep);
  }
};

/// One step of W hairs.
template <typename T, int W, typename Segment>
struct Mover : Turns<T, W> {
  using Base = Turns<T, W>;
  using Hulls = AtHull<T, W>;
  using Out = KeepOut<T, W>;
  using Ball = typename Hulls::Ball;
  using Base::All;
  using Base::Row;
  using Base::Rows;
  using Base::Times;
  using typename Base::V;
  using typename Base::Vec;

  static void Step(const layout::MotionShape<T>& shape, const layout::MotionStep<T>& step, int lane,
                   const T* constants, const T* wind, T* state) {
    constexpr int kConstants = layout::kConstantsPerSegment * layout::kLanes;
    constexpr int kState = Segment::kRows * layout::kLanes;
    const Vec root = Rows(constants, layout::kRoot);
    const V d = Row(constants, layout::kSegmentLength);
    const V beta = step.drag_scale * Row(constants, layout::kDrag);
    const V tau_dt = (step.friction_scale * step.dt) * Row(constants, layout::kFriction);
    const Vec velocity = All(step.velocity) + Times(step.turning, root);
    const Vec field = All(step.field) - Times(step.sway, root) + beta * (Rows(wind, 0) - velocity);
    Load<V> load{V{}, V{}, step.dt * beta, V{}, All(step.head_step)};

    // Nodes: where the hull is a ball, with directions before the step; in world axes, after it, as
    // Nodes sums them.
    const Ball ball{step, All(shape.center)};
    Vec p = Times(step.R, root), previous{}, y_begin = ball.At(p);
    // Directions that are kept as angles are moved by rounding.
    const V reach = T(1) + shape.reach_per_length * d;

    constants += layout::kFirstSegment * layout::kLanes;
    for (int i = 0; i < shape.segments; ++i, constants += kConstants, state += kState) {
      Segment segment(state, step.carried);
      const Vec from = segment.e;
      const bool first = i == 0;
      Vec rest{};
      if (shape.holds || first) rest = Times(step.R, Rows(constants, layout::kRest));
      if (shape.weakens) y_begin += d * ball.Along(from);
      Vec e = rest;
      if (first && shape.clamped) {
        segment.Correct(d == d, e, Base::Moved(from, e));
      } else {
        const V K = Row(constants, layout::kHold), lambda = Row(constants, layout::kResponse);
        Vec F = field;
        if (shape.holds) F += K * rest;
        if (shape.weakens && shape.segment[i].epsilon < T(1)) {
          Hulls::Weaken(shape, ball, shape.segment[i].epsilon, y_begin, F);
        }
        load.push = (step.dt * step.dt) * lambda;
        load.bound = shape.bounded ? load.push : V{};
        load.friction = lambda * K * tau_dt;
        e = segment.Step(load, F);
        Adjust(shape, ball, lane, i, reach, p, d, previous, from, segment, e);
      }
      e = segment.Kept(e);
      segment.Write(e, state);
      if (shape.avoid_hull) p += d * e;
      previous = e;
    }
  }

  static void Nodes(const layout::MotionShape<T>& shape, const layout::MotionPlace<T>& place,
                    const T* constants, const T* state, T* nodes) {
    const V d = Row(constants, layout::kSegmentLength);
    Vec p = Times(place.R, Rows(constants, layout::kRoot));
    Base::Put(p, nodes, 0);
    for (int i = 0; i < shape.segments; ++i, state += Segment::kRows * layout::kLanes) {
      p += d * Segment::Direction(state);
      Base::Put(p, nodes, 3 * (i + 1));
    }
  }

 private:
  // After the recurrence, in this order: B15, B14, B6. What moves a segment there moves it in
  // truth: its step becomes what it went, so that it does not go on pushing.
  [[gnu::always_inline]] static void Adjust(const layout::MotionShape<T>& shape, const Ball& ball,
                                            int lane, int i, const V& reach, const Vec& p,
                                            const V& d, const Vec& previous, Vec from,
                                            Segment& segment, Vec& e) {
    const layout::MotionStep<T>& step = ball.step;
    if (step.fluctuates) {
      const Vec before = e;
      Vec drawn = Base::Drawn(shape, step, lane, i, e);
      Base::Turn(e, drawn);
      from = Base::TurnedAlong(from, before, e);
      segment.Fluctuate(before, e);
      e = segment.Kept(e);
    }
    auto moved = d < V{};
    if (shape.joints && i > 0) moved = moved | Base::Bend(shape.segment[i], previous, e);
    auto inside = d < V{};
    V speed{};
    if (shape.avoid_hull) {
      inside = Out::Level(ball, p + d * e) < reach;
      if (Any(inside)) {
        const Vec past = segment.LastStep() - Cross(All(step.head_step), e);
        speed = Dot(past, past);
        e = Out::TurnedOut(ball, reach, inside, p, d, e, e);
        moved = moved | inside;
      }
    }
    if (!Any(moved)) return;
    Vec went = Base::Moved(from, e);
    if (shape.avoid_hull) {
      const Vec rides = Cross(All(step.head_step), e);
      went = Select(inside, Hulls::Stopped(ball, p + d * e, e, rides, speed, went), went);
    }
    segment.Correct(moved, e, went);
  }
};

template <typename T, int W>
void StepBlock(const layout::MotionShape<T>& shape, const layout::MotionStep<T>& step,
               const T* constants, const T* wind, T* state) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    const auto go = shape.polar ? &Mover<T, W, PolarSegment<T, W>>::Step
                                : &Mover<T, W, AcrossSegment<T, W>>::Step;
    go(shape, step, lane, constants + lane, wind + lane, state + lane);
  }
}

template <typename T, int W>
void BlockNodes(const layout::MotionShape<T>& shape, const layout::MotionPlace<T>& place,
                const T* constants, const T* state, T* nodes) {
  for (int lane = 0; lane < layout::kLanes; lane += W) {
    const auto go = shape.polar ? &Mover<T, W, PolarSegment<T, W>>::Nodes
                                : &Mover<T, W, AcrossSegment<T, W>>::Nodes;
    go(shape, place, constants + lane, state + lane, nodes + lane);
  }
}

template <typename T, int W>
constexpr MotionKernels<T> MakeMotion() {
  return {&StepBlock<T, W>, &BlockNodes<T, W>};
}

}  // namespace MANE_ISA
}  // namespace mane::beam
