#include "head/beam_motion.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <span>
#include <vector>

#include "head/head.h"
#include "head/kernels.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Row = simd::Row<float>;

constexpr int kBlocksPerPiece = 4;

// How the head moves in every step of a movement.
struct Course {
  Vector3d velocity, spin;
};
Course CourseOf(const math::Pose& from, const Movement& movement) {
  return {(movement.target.p - from.p) / movement.duration,
          math::RotationVector(movement.target.q * from.q.conjugate()) / movement.duration};
}

// A step of a movement, for all blocks.
struct Step {
  beam::MotionDrive drive;
  double time;               // Of its middle [s].
  std::array<Row, 3> air{};  // Without eddies.
};

// All steps of a movement.
void SetSteps(const HeadState& state, const Movement& movement, const Environment& environment,
              const WindField& wind, std::vector<Step>* all) {
  const BeamState& before = state.beams;
  const Course course = CourseOf(state.pose, movement);
  const int steps = StepCount(movement);
  const double dt = movement.duration / steps;
  all->resize(steps);
  for (int i = 0; i < steps; ++i) {
    Step& step = (*all)[i];
    beam::MotionDrive& drive = step.drive;
    drive.head = i + 1 == steps ? movement.target
                                : math::Interpolate(state.pose, movement.target,
                                                    static_cast<double>(i + 1) / steps);
    drive.velocity_before = i == 0 ? before.velocity : course.velocity;
    drive.spin_before = i == 0 ? before.spin : course.spin;
    drive.velocity = course.velocity;
    drive.spin = course.spin;
    drive.gravity = environment.gravity;
    drive.duration = dt;
    drive.duration_before = i == 0 ? before.duration : dt;
    drive.drag_scale = environment.air_drag_scale;
    drive.friction_scale = environment.internal_friction_scale;
    drive.frame = before.steps + static_cast<uint64_t>(i);
    step.time = state.time + (i + 0.5) * dt;
    const Vector3d mean = wind.Mean(step.time);
    for (int axis = 0; axis < 3; ++axis) {
      std::ranges::fill(step.air[axis].lane, static_cast<float>(mean[axis]));
    }
  }
}

// The air at the roots of a block.
std::array<Row, 3> AirAt(const WindField& wind, const std::array<Row, 3>& roots, const Step& step) {
  std::array<Row, 3> air = step.air;
  if (!wind.turbulent()) return air;
  const Eigen::Matrix3f R = step.drive.head.q.toRotationMatrix().cast<float>();
  std::array<Row, 3> turned;
  for (int lane = 0; lane < simd::kLanes; ++lane) {
    const Eigen::Vector3f root =
        R * Eigen::Vector3f(roots[0].lane[lane], roots[1].lane[lane], roots[2].lane[lane]);
    for (int axis = 0; axis < 3; ++axis) turned[axis].lane[lane] = root[axis];
  }
  wind.Evaluate(step.time, step.drive.head.p, turned, air);
  return air;
}

// Puts hairs of a block to rest that are not finite. Returns how many.
int RepairBlock(const Beams& beams, int block, const math::Pose& head, double duration,
                std::span<Row> state) {
  thread_local std::vector<Row> nodes;
  thread_local std::vector<Vector3d> directions;
  const int k = beams.segments;
  nodes.resize(static_cast<size_t>(3) * (k + 1));
  beams.batch.Nodes(BeamKernels(), block, head, state, nodes);
  int repaired = 0;
  for (int lane = 0; lane < simd::kLanes; ++lane) {
    const int hair = block * simd::kLanes + lane;
    if (hair >= beams.batch.hair_count()) break;
    // A node is the sum of all segments before it.
    const Row* const tip = &nodes[static_cast<size_t>(3) * k];
    if (std::isfinite(tip[0].lane[lane] + tip[1].lane[lane] + tip[2].lane[lane])) continue;
    const auto rest = beams.rest_of(hair);
    directions.resize(k);
    for (int i = 0; i < k; ++i) directions[i] = head.q * rest[i];
    beams.batch.SetHair(hair, directions, {}, duration, state);
    ++repaired;
  }
  return repaired;
}

}  // namespace

void PutBeamsToRest(const math::Pose& pose, BeamState* state) {
  state->rows = state->beams->rest;
  state->beams->batch.Rotate(pose.q.toRotationMatrix(), state->rows);
  state->velocity.setZero();
  state->spin.setZero();
}

void TurnBeams(const Eigen::Quaterniond& turn, BeamState* state) {
  state->velocity = turn * state->velocity;
  state->spin = turn * state->spin;
  if (state->active) state->beams->batch.Rotate(turn.toRotationMatrix(), state->rows);
}

int AdvanceBeams(const Movement& movement, const Environment& environment, HeadState* state,
                 exec::WorkerPool& pool) {
  BeamState& own = state->beams;
  const Beams& beams = *own.beams;
  const WindField wind(environment.wind, environment.wind_variation);
  thread_local std::vector<Step> own_steps;
  std::vector<Step>& steps = own_steps;
  SetSteps(*state, movement, environment, wind, &steps);
  std::atomic<int> repaired = 0;
  pool.ParallelFor(beams.batch.blocks(), kBlocksPerPiece, [&](int first, int last) {
    for (int block = first; block < last; ++block) {
      for (const Step& step : steps) {
        beams.batch.Step(BeamKernels(), block, step.drive, AirAt(wind, beams.roots[block], step),
                         own.rows);
      }
      repaired += RepairBlock(beams, block, movement.target, steps.back().drive.duration, own.rows);
    }
  });
  own.steps += steps.size();
  return repaired;
}

void RememberMovement(const Movement& movement, HeadState* state) {
  const Course course = CourseOf(state->pose, movement);
  state->beams.velocity = course.velocity;
  state->beams.spin = course.spin;
  state->beams.duration = movement.duration / StepCount(movement);
}

}  // namespace mane::head
