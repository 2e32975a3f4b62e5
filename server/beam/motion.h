#pragma once

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "beam/hull.h"
#include "beam/kernels.h"
#include "math/rigid.h"
#include "simd/rows.h"

namespace mane::beam {

/// Along which angles a segment turns ([AUK92] 3.1).
enum class Equations {
  /// The polar axis lies across the segment, chosen anew every step: B8 with sin t = 1. A segment
  /// answers alike in all directions, nothing is singular.
  kAcross,
  /// The polar axis is Y, as published (B7 to B9).
  kPolar,
};

/// How hairs of a batch move; the same for all. Arrays over segments are (k), or empty for all
/// default.
struct MotionSettings {
  Equations equations = Equations::kAcross;
  /// Whether the recurrences are divided so that no step is too long (B12); without, they are as
  /// published, stable while dt^2 lambda |F| < 4.
  bool bounded = true;
  bool clamped = true;  ///< Segment 1 keeps its direction in the head; otherwise it swings as well.
  std::optional<Hull> hull;  ///< Of the head, its frame; empty for none.
  bool avoid_hull = true;    ///< Turn nodes out of it (B6).
  /// Pseudo-force field (B13): where grad E . F < alpha |grad E| |F| and the segment is nearer to
  /// the hull than `near` [m], F counts epsilon_i times.
  double alpha = -0.75;  ///< In [-1, 1]; -1 for none.
  double near = 0.02;
  std::vector<float> epsilon;  ///< In [0, 1]; 1 by default.
  /// Largest angle between segments i - 1 and i (B14) [rad], in [0, pi]; pi by default. The first,
  /// of no joint, counts for nothing.
  std::vector<float> largest_turn;
  /// Every ten frames each segment turns by angles drawn evenly from [-fluctuation, fluctuation]
  /// (B15) [rad].
  double fluctuation = 0;
  uint64_t seed = 0;
};

/// One hair of a batch (response.h). Arrays over segments are (k).
struct MotionHair {
  Eigen::Vector3d root;                   ///< p_0, head frame [m].
  double segment_length;                  ///< d [m]
  std::span<const Eigen::Vector3d> rest;  ///< Directions at rest, unit, head frame.
  std::span<const double> response;       ///< lambda_i [1/m] (B8).
  /// K_i [m/s^2], >= 0: the field that holds segment i in its rest direction (B11). 0 as published.
  std::span<const double> hold;
  double drag = 0;      ///< beta [1/s]: of the air (B12).
  double friction = 0;  ///< tau [s]: internal friction over stiffness (B12).
};

/// What happens to a block's hairs in a step; the same for all lanes but the wind.
struct MotionDrive {
  math::Pose head;  ///< head -> world at the end of the step.
  /// The head's velocity and spin in the step before and in this one, world: roots accelerate by
  /// what changes [m/s], [rad/s].
  Eigen::Vector3d velocity_before, velocity, spin_before, spin;
  Eigen::Vector3d gravity;     ///< World [m/s^2].
  double duration;             ///< dt [s], > 0.
  double duration_before = 0;  ///< Of the step before [s]; 0 where it was as long.
  double drag_scale = 1, friction_scale = 1;
  /// Frames since the beginning; every tenth draws what B15 says.
  uint64_t frame = 0;
};

/// Hairs of equal k packed into blocks of simd::kLanes, with their constants. Immutable; what moves
/// is a separate array of `state_rows()` rows with one owner.
///
/// T is float where speed counts, double where tests compare with the reference.
template <typename T>
class MotionBatch {
 public:
  using Row = simd::Row<T>;

  MotionBatch() = default;
  /// @param gravity  under which hairs are at rest with the head upright, head frame [m/s^2] (B11);
  ///                 zero for hair as published, which nothing holds.
  MotionBatch(int segments, std::span<const MotionHair> hairs, const Eigen::Vector3d& gravity,
              const MotionSettings& settings);

  [[nodiscard]] int segments() const { return segments_; }
  [[nodiscard]] int hair_count() const { return hair_count_; }
  [[nodiscard]] int blocks() const;
  [[nodiscard]] size_t state_rows() const;
  [[nodiscard]] const MotionSettings& settings() const { return settings_; }

  /// Puts a hair to directions (k), world, with rates of change d e/dt [1/s] (k), of which only
  /// what is across them counts; empty for none. `duration` [s] is that of the last step.
  void SetHair(int hair, std::span<const Eigen::Vector3d> directions,
               std::span<const Eigen::Vector3d> rates, double duration, std::span<Row> state) const;
  /// Directions (k) and, unless empty, their rates (k), world.
  void GetHair(int hair, double duration, std::span<const Row> state,
               std::span<Eigen::Vector3d> directions, std::span<Eigen::Vector3d> rates) const;
  /// Turns directions and rates of all hairs.
  void Rotate(const Eigen::Matrix3d& turn, std::span<Row> state) const;

  /// Advances block `block` by one step. No allocation.
  ///
  /// @param wind   air velocity at the roots, world [m/s], lane by lane.
  /// @param state  of the whole batch, (state_rows).
  void Step(const KernelTable<T>& kernels, int block, const MotionDrive& drive,
            std::span<const Row, 3> wind, std::span<Row> state) const;
  /// Nodes of a block, ((k + 1) x 3) rows, from the head's place, world axes [m].
  void Nodes(const KernelTable<T>& kernels, int block, const math::Pose& head,
             std::span<const Row> state, std::span<Row> nodes) const;

 private:
  int segments_ = 0;
  int hair_count_ = 0;
  MotionSettings settings_;
  [[nodiscard]] layout::MotionShape<T> Shape() const;
  [[nodiscard]] layout::MotionStep<T> StepNumbers(int block, const MotionDrive& drive) const;
  [[nodiscard]] size_t constant_rows() const;
  [[nodiscard]] int segment_rows() const;  // Of a state.
  // Calls visit(first row of its block, lane) for every lane that holds a hair: the last one's
  // fills its block.
  template <typename Visit>
  void ForLanes(int hair, std::span<Row> state, const Visit& visit) const;

  Hull lifted_;  // What nodes keep out of.
  Eigen::Vector3d gravity_ = Eigen::Vector3d::Zero();
  bool holds_ = false;
  std::vector<layout::SegmentNumbers<T>> numbers_;  // (segments)
  std::vector<Row> constants_;                      // (blocks x constant_rows())
};

}  // namespace mane::beam
