#include "beam/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "beam/packing.h"
#include "math/random.h"

namespace mane::beam {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using layout::kLanes;

// Frames between two that B15 draws for.
constexpr uint64_t kFluctuationPeriod = 10;

template <typename T>
constexpr double kEpsilon = std::numeric_limits<T>::epsilon();

Matrix3d Turn(const Vector3d& rotation) {
  return math::FromRotationVector(rotation).toRotationMatrix();
}

// Where angles t and f grow (B7).
struct Tangents {
  Vector3d e, u, v;
  double sine;  // Of t.

  Tangents(double t, double f)
      : e(DirectionOf(t, f)),
        u(std::cos(t) * std::sin(f), -std::sin(t), std::cos(t) * std::cos(f)),
        v(std::cos(f), 0, -std::sin(f)),
        sine(std::sin(t)) {}
};

// Puts one lane of a segment's state to a direction and its step.
template <typename T>
void SetSegment(bool polar, const Vector3d& e, const Vector3d& step, int lane, simd::Row<T>* rows) {
  if (!polar) {
    SetLane<T>(e, lane, rows + layout::kDirection);
    SetLane<T>(step - step.dot(e) * e, lane, rows + layout::kStep);
    return;
  }
  const auto [t, f] = PolarOf(Hull(), e);
  const Tangents at(t, f);
  const auto set = [&](int row, double value) { rows[row].lane[lane] = static_cast<T>(value); };
  set(layout::kZenith, t);
  set(layout::kAzimuth, f);
  set(layout::kZenithStep, step.dot(at.u));
  set(layout::kAzimuthStep,
      at.sine > layout::kAxis
          ? std::clamp(step.dot(at.v) / at.sine, -layout::kMostTurn, layout::kMostTurn)
          : 0);
}

// Reads them back.
template <typename T>
void GetSegment(bool polar, const simd::Row<T>* rows, int lane, Vector3d* e, Vector3d* step) {
  if (!polar) {
    *e = VectorAt(rows + layout::kDirection, lane).normalized();
    *step = VectorAt(rows + layout::kStep, lane);
    return;
  }
  const auto at = [&](int row) { return static_cast<double>(rows[row].lane[lane]); };
  const Tangents along(at(layout::kZenith), at(layout::kAzimuth));
  *e = along.e;
  *step = at(layout::kZenithStep) * along.u + at(layout::kAzimuthStep) * along.sine * along.v;
}

}  // namespace

template <typename T>
MotionBatch<T>::MotionBatch(int segments, std::span<const MotionHair> hairs,
                            const Vector3d& gravity, const MotionSettings& settings)
    : segments_(segments),
      hair_count_(static_cast<int>(hairs.size())),
      settings_(settings),
      lifted_(settings.hull ? Lifted(*settings.hull, kEpsilon<T>) : Hull()),
      gravity_(gravity) {
  MANE_CHECK(segments >= 1);
  MANE_CHECK(settings.epsilon.empty() || static_cast<int>(settings.epsilon.size()) == segments);
  MANE_CHECK(settings.largest_turn.empty() ||
             static_cast<int>(settings.largest_turn.size()) == segments);
  for (int i = 0; i < segments; ++i) {
    const double turn = settings.largest_turn.empty() ? std::numbers::pi : settings.largest_turn[i];
    // A half turn is never too much, not by rounding either.
    const double cosine = turn < std::numbers::pi ? std::cos(turn) : -2;
    numbers_.push_back({settings.epsilon.empty() ? T(1) : static_cast<T>(settings.epsilon[i]),
                        static_cast<T>(cosine), static_cast<T>(std::sin(turn))});
  }
  constants_.resize(blocks() * constant_rows());
  for (int place = 0; place < blocks() * kLanes; ++place) {
    const MotionHair& hair = hairs[std::min(place, hair_count_ - 1)];
    MANE_CHECK(static_cast<int>(hair.rest.size()) == segments);
    MANE_CHECK(static_cast<int>(hair.response.size()) == segments);
    MANE_CHECK(static_cast<int>(hair.hold.size()) == segments);
    const int lane = place % kLanes;
    Row* row = &constants_[place / kLanes * constant_rows()];
    SetLane<T>(hair.root, lane, row + layout::kRoot);
    row[layout::kSegmentLength].lane[lane] = static_cast<T>(hair.segment_length);
    row[layout::kDrag].lane[lane] = static_cast<T>(hair.drag);
    row[layout::kFriction].lane[lane] = static_cast<T>(hair.friction);
    row += layout::kFirstSegment;
    for (int i = 0; i < segments; ++i, row += layout::kConstantsPerSegment) {
      SetLane<T>(hair.rest[i].normalized(), lane, row + layout::kRest);
      row[layout::kHold].lane[lane] = static_cast<T>(hair.hold[i]);
      row[layout::kResponse].lane[lane] = static_cast<T>(hair.response[i]);
      holds_ |= hair.hold[i] > 0;
    }
  }
}

template <typename T>
int MotionBatch<T>::blocks() const {
  return simd::BlocksOf(hair_count_);
}

template <typename T>
int MotionBatch<T>::segment_rows() const {
  return settings_.equations == Equations::kPolar ? static_cast<int>(layout::kPolarState)
                                                  : static_cast<int>(layout::kAcrossState);
}

template <typename T>
size_t MotionBatch<T>::constant_rows() const {
  return layout::kFirstSegment + static_cast<size_t>(segments_) * layout::kConstantsPerSegment;
}

template <typename T>
size_t MotionBatch<T>::state_rows() const {
  return static_cast<size_t>(blocks()) * segments_ * segment_rows();
}

template <typename T>
layout::MotionShape<T> MotionBatch<T>::Shape() const {
  const bool hull = settings_.hull.has_value();
  layout::MotionShape<T> shape{};
  shape.segments = segments_;
  shape.polar = settings_.equations == Equations::kPolar;
  shape.bounded = settings_.bounded;
  shape.clamped = settings_.clamped;
  shape.avoid_hull = hull && settings_.avoid_hull;
  shape.weakens = hull && settings_.alpha > -1 &&
                  std::ranges::any_of(numbers_, [](const auto& n) { return n.epsilon < T(1); });
  shape.joints = std::ranges::any_of(numbers_, [](const auto& n) { return n.cos_turn > T(-1); });
  shape.holds = holds_;
  shape.alpha = static_cast<T>(settings_.alpha);
  shape.twice_near = static_cast<T>(2 * settings_.near);
  shape.fluctuation = static_cast<T>(settings_.fluctuation);
  Fill<T>(lifted_.center.cwiseQuotient(lifted_.radii), shape.center);
  // Angles that turn by four epsilon move E by twice that, over the least radius.
  shape.reach_per_length =
      shape.polar ? static_cast<T>(8 * kEpsilon<T> / lifted_.radii.minCoeff()) : T(0);
  shape.segment = numbers_.data();
  return shape;
}

template <typename T>
layout::MotionStep<T> MotionBatch<T>::StepNumbers(int block, const MotionDrive& drive) const {
  const double dt = drive.duration;
  const double dt_before = drive.duration_before > 0 ? drive.duration_before : dt;
  const Matrix3d R = drive.head.q.toRotationMatrix();
  // Velocities are those in the middle of a step.
  const Vector3d turn = dt * drive.spin;
  const Matrix3d middle = Turn(-0.5 * turn) * R;
  const Matrix3d middle_before = Turn(-0.5 * dt_before * drive.spin_before) * Turn(-turn) * R;
  const Matrix3d turning = math::Cross(drive.spin) * middle;
  const Matrix3d turning_before = math::Cross(drive.spin_before) * middle_before;

  layout::MotionStep<T> step;
  Fill<T>(R, step.R);
  Fill<T>(lifted_.radii.cwiseInverse().asDiagonal() * R.transpose(), step.to_hull);
  Fill<T>(drive.velocity, step.velocity);
  Fill<T>(turning, step.turning);
  Fill<T>(drive.gravity - R * gravity_ - (drive.velocity - drive.velocity_before) / dt, step.field);
  Fill<T>((turning - turning_before) / dt, step.sway);
  Fill<T>(turn, step.head_step);
  step.dt = static_cast<T>(dt);
  step.carried = static_cast<T>(dt / dt_before);
  step.drag_scale = static_cast<T>(drive.drag_scale);
  step.friction_scale = static_cast<T>(drive.friction_scale);
  step.fluctuates = settings_.fluctuation > 0 && drive.frame % kFluctuationPeriod == 0;
  const uint64_t key = math::RandomStream(settings_.seed, drive.frame / kFluctuationPeriod).Bits();
  step.keys[0] = static_cast<uint32_t>(key);
  step.keys[1] = static_cast<uint32_t>(key >> 32);
  step.first_hair = static_cast<uint32_t>(block * kLanes);
  return step;
}

template <typename T>
template <typename Visit>
void MotionBatch<T>::ForLanes(int hair, std::span<Row> state, const Visit& visit) const {
  MANE_CHECK(hair >= 0 && hair < hair_count_ && state.size() == state_rows());
  const int last = hair == hair_count_ - 1 ? blocks() * kLanes - 1 : hair;
  Row* const rows = &state[static_cast<size_t>(hair / kLanes) * segments_ * segment_rows()];
  for (int place = hair; place <= last; ++place) visit(rows, place % kLanes);
}

template <typename T>
void MotionBatch<T>::SetHair(int hair, std::span<const Vector3d> directions,
                             std::span<const Vector3d> rates, double duration,
                             std::span<Row> state) const {
  const bool polar = settings_.equations == Equations::kPolar;
  ForLanes(hair, state, [&](Row* rows, int lane) {
    for (int i = 0; i < segments_; ++i, rows += segment_rows()) {
      const Vector3d rate = rates.empty() ? Vector3d::Zero() : rates[i];
      SetSegment<T>(polar, directions[i].normalized(), duration * rate, lane, rows);
    }
  });
}

template <typename T>
void MotionBatch<T>::GetHair(int hair, double duration, std::span<const Row> state,
                             std::span<Vector3d> directions, std::span<Vector3d> rates) const {
  const bool polar = settings_.equations == Equations::kPolar;
  const Row* rows = &state[static_cast<size_t>(hair / kLanes) * segments_ * segment_rows()];
  for (int i = 0; i < segments_; ++i, rows += segment_rows()) {
    Vector3d step;
    GetSegment<T>(polar, rows, hair % kLanes, &directions[i], &step);
    if (!rates.empty()) rates[i] = step / duration;
  }
}

template <typename T>
void MotionBatch<T>::Rotate(const Matrix3d& turn, std::span<Row> state) const {
  const bool polar = settings_.equations == Equations::kPolar;
  for (size_t row = 0; row < state_rows(); row += segment_rows()) {
    for (int lane = 0; lane < kLanes; ++lane) {
      Vector3d e, step;
      GetSegment<T>(polar, &state[row], lane, &e, &step);
      SetSegment<T>(polar, (turn * e).normalized(), turn * step, lane, &state[row]);
    }
  }
}

template <typename T>
void MotionBatch<T>::Step(const KernelTable<T>& kernels, int block, const MotionDrive& drive,
                          std::span<const Row, 3> wind, std::span<Row> state) const {
  kernels.motion.step(Shape(), StepNumbers(block, drive), constants_[block * constant_rows()].lane,
                      wind[0].lane,
                      state[static_cast<size_t>(block) * segments_ * segment_rows()].lane);
}

template <typename T>
void MotionBatch<T>::Nodes(const KernelTable<T>& kernels, int block, const math::Pose& head,
                           std::span<const Row> state, std::span<Row> nodes) const {
  layout::MotionPlace<T> place;
  Fill<T>(head.q.toRotationMatrix(), place.R);
  kernels.motion.nodes(Shape(), place, constants_[block * constant_rows()].lane,
                       state[static_cast<size_t>(block) * segments_ * segment_rows()].lane,
                       nodes[0].lane);
}

template class MotionBatch<float>;
template class MotionBatch<double>;

}  // namespace mane::beam
