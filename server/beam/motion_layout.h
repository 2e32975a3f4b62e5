#pragma once

#include <cstdint>

#include "simd/rows.h"

/// How a block of moving hairs lies in memory, and what is the same for all its lanes: agreed on by
/// motion.cpp, which writes constants, and the kernels of every instruction set.
namespace mane::beam::layout {

using simd::kLanes;

/// Rows of a block's constants: of the hair, then of each segment.
enum ConstantRow {
  kRoot = 0,           ///< p_0, head frame [m], 3 rows.
  kSegmentLength = 3,  ///< d [m]
  kDrag = 4,           ///< beta [1/s]
  kFriction = 5,       ///< tau [s]
  kFirstSegment = 6,
};
enum SegmentConstantRow {
  kRest = 0,      ///< Direction at rest, head frame, 3 rows.
  kHold = 3,      ///< K [m/s^2]
  kResponse = 4,  ///< lambda [1/m]
  kConstantsPerSegment = 5,
};

/// Rows of a segment's state: Equations::kAcross.
enum AcrossStateRow {
  kDirection = 0,  ///< e, world, 3 rows.
  kStep = 3,       ///< delta [rad], across e, world, 3 rows.
  kAcrossState = 6,
};
/// Below this |sin t| the azimuth says nothing any more.
inline constexpr double kAxis = 1e-4;
/// Largest step of f of a direction that is put to a place [rad]: near the axis a short way is a
/// long turn, which would go on far from it.
inline constexpr double kMostTurn = 1.25;
/// Equations::kPolar.
enum PolarStateRow {
  kZenith = 0,       ///< t [rad], in [-pi, pi].
  kAzimuth = 1,      ///< f [rad], in [-pi, pi].
  kZenithStep = 2,   ///< Of the last step [rad].
  kAzimuthStep = 3,  ///< [rad]
  kPolarState = 4,
};

/// Numbers of a segment that all hairs share.
template <typename T>
struct SegmentNumbers {
  T epsilon;             ///< B13
  T cos_turn, sin_turn;  ///< Of the largest turn (B14).
};

/// What a batch does, in numbers of its kernels.
template <typename T>
struct MotionShape {
  int segments;
  bool polar;
  bool bounded;
  bool clamped;
  bool avoid_hull;
  bool weakens;  ///< Whether any epsilon is below 1 and there is a hull.
  bool joints;   ///< Whether any turn is limited.
  bool holds;    ///< Whether any K is above 0.
  T alpha, twice_near;
  T fluctuation;  ///< [rad]
  T center[3];    ///< Of the hull, where it is the unit ball.
  /// What E of a node must reach over the length of its segment [1/m] (B6).
  T reach_per_length;
  const SegmentNumbers<T>* segment;  ///< (segments)
};

/// What happens in a step, in numbers of its kernels. Matrices by rows.
template <typename T>
struct MotionStep {
  T R[9];          ///< Head to world.
  T to_hull[9];    ///< World axes to the hull's, in which it is the unit ball.
  T velocity[3];   ///< Of the head's place [m/s]; of a root r velocity + turning r.
  T turning[9];    ///< [1/s]
  T field[3];      ///< On a hair at the head's place, less R g0 [m/s^2]; of a root less sway r.
  T sway[9];       ///< [1/s^2]
  T head_step[3];  ///< The head's rotation [rad].
  T dt;            ///< [s]
  T carried;       ///< dt over that of the step before.
  T drag_scale, friction_scale;
  bool fluctuates;  ///< Whether this is a frame of B15, with these keys:
  uint32_t keys[2];
  uint32_t first_hair;  ///< Of the block.
};

/// Where a block's hairs are wanted.
template <typename T>
struct MotionPlace {
  T R[9];  ///< Head to world, by rows.
};

}  // namespace mane::beam::layout
