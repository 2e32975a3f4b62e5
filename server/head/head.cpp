#include "head/head.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <span>

#include "base/check.h"
#include "head/kernels.h"
#include "head/wisps.h"
#include "rod/scheme.h"

namespace mane::head {
namespace {

using Drive = std::array<rod::Row<float>, rod::layout::kDriveRows>;

// What drives all blocks in a step, and where and when it is linearised.
struct StepDrive {
  Drive rows;
  double time;
  math::Pose head;
  std::vector<contact::GroupMotion> bodies;
  double surprise;
};

// Blocks advanced in one piece by one worker: a piece takes longer than handing it over.
constexpr int kBlocksPerPiece = 4;
// Steps that a piece makes at a time, whose drives are at hand together.
constexpr int kStepsAtOnce = 16;

void PutToRest(const groom::Groom& groom, int guide, HeadState* state) {
  groom.batch.SetStill(guide, groom.rest_of(guide), state->guides);
}

int LevelOf(const HeadState& state, int block) {
  return state.detail.levels ? state.detail.blocks[block].level : 0;
}

// Takes all blocks to full detail. The levels stay at hand.
void StopDetail(const groom::Groom& groom, HeadState* state) {
  if (!state->detail.levels) return;
  for (int i = 0; i < std::ssize(groom.batch.blocks()); ++i) {
    state->detail.blocks[i].calm = 0;
    if (LevelOf(*state, i) == 0) continue;
    SwitchBlock(groom, i, 0, state->pose, state->guides, &state->detail);
    ForgetContact(i, {}, &state->contact);
  }
}

// After the last step of a movement: what a block shows, and whether its level still suits it.
void FinishBlock(const groom::Groom& groom, int i, const Movement& movement, double tolerance,
                 HeadState* state) {
  Detail& detail = state->detail;
  if (LevelOf(*state, i) > 0) ShowBlock(groom, i, movement.duration, state->guides, &detail);
  const int level = ChooseLevel(groom, i, movement.duration, tolerance, state->guides, &detail);
  if (level != LevelOf(*state, i)) {
    SwitchBlock(groom, i, level, movement.target, state->guides, &detail);
    ForgetContact(i, level == 0 ? rod::Parts{} : detail.levels->At(i, level).parts,
                  &state->contact);
  }
}

// Steps [begin, end) of `steps` equal ones along `movement`, which starts at `from`.
void SetDrives(const HeadState& from, const Movement& movement, int steps, int begin, int end,
               const Environment& environment, const WindField& wind,
               std::vector<StepDrive>* drives) {
  drives->resize(kStepsAtOnce * kFinestOfWisps);
  const auto pose = [&](int i) {
    return i == steps
               ? movement.target
               : math::Interpolate(from.pose, movement.target, static_cast<double>(i) / steps);
  };
  for (int i = begin; i < end; ++i) {
    StepDrive& drive = (*drives)[i - begin];
    const double dt = movement.duration / steps;
    const rod::ClampMotion motion{pose(i), pose(i + 1), dt};
    drive.time = from.time + (i + rod::kTheta) * dt;
    drive.head = math::Interpolate(motion.begin, motion.end, rod::kTheta);
    Environment air = environment;
    air.wind = wind.Mean(drive.time);
    rod::SetDrive<float>(motion, air, 0, rod::layout::kLanes, drive.rows);
    // Steps of one movement are alike.
    drive.surprise = i == 0 ? Surprise(from.contact, motion) : 0;
    SetGroupMotions(from.contact, movement.bodies, motion, static_cast<double>(i) / steps,
                    static_cast<double>(i + 1) / steps, &drive.bodies);
  }
}

// The eddies at the roots of a block.
void SetEddies(const groom::Groom& groom, const rod::Batch<float>::Block& block,
               const StepDrive& drive, const WindField& wind, Drive* rows) {
  const float* const constants =
      groom.batch.constants(block) + rod::layout::kRootPosition * rod::layout::kLanes;
  const Eigen::Matrix3f R = drive.head.q.toRotationMatrix().cast<float>();
  std::array<rod::Row<float>, 3> roots;
  for (int lane = 0; lane < rod::layout::kLanes; ++lane) {
    const Eigen::Vector3f root =
        R * Eigen::Vector3f(constants[lane], constants[rod::layout::kLanes + lane],
                            constants[2 * rod::layout::kLanes + lane]);
    for (int i = 0; i < 3; ++i) roots[i].lane[lane] = root[i];
  }
  wind.Evaluate(drive.time, drive.head.p, roots, std::span(*rows).subspan<rod::layout::kWind, 3>());
}

// The rows of block `i` that steps change.
Rows MovingRows(const groom::Groom& groom, int i, HeadState* state) {
  if (LevelOf(*state, i) > 0) return CoarseState(groom, i, &state->detail);
  const rod::Batch<float>::Block& block = groom.batch.blocks()[i];
  return Rows(state->guides)
      .subspan(block.state,
               static_cast<size_t>(block.elements) * rod::layout::StateRowsPerElement(block.kind));
}

// One step of one block at its level; bit i is set where lane i failed. `bend` is as of
// contact::StepBlockAmong.
uint32_t StepAtLevel(const groom::Groom& groom, int i, const StepDrive& drive, const Drive& rows,
                     HeadState* state, float* bend) {
  thread_local rod::BatchScratch scratch;
  const bool full = LevelOf(*state, i) == 0;
  const rod::Batch<float>& batch =
      full ? groom.batch : state->detail.levels->At(i, LevelOf(*state, i)).batch;
  const rod::Batch<float>::Block& block = batch.blocks()[full ? i : 0];
  const Rows moving = full ? Rows(state->guides) : CoarseState(groom, i, &state->detail);
  if (state->contact.bodies != nullptr) {
    return StepAmongBodies(i, batch, block, rows, drive.bodies, drive.surprise, moving,
                           &state->contact, bend);
  }
  return rod::StepBlock<float>(Kernels(), batch, block, rows, moving, scratch);
}

// Puts the strands of block `i` to rest that failed in a step. Returns how many.
int Repair(const groom::Groom& groom, int i, uint32_t failed, HeadState* state) {
  const rod::Batch<float>::Block& block = groom.batch.blocks()[i];
  int repaired = 0;
  for (int lane = 0; failed != 0 && lane < block.count; ++lane) {
    if ((failed >> lane & 1) == 0) continue;
    PutToRest(groom, block.strands[lane], state);
    if (LevelOf(*state, i) > 0) RestLane(groom, i, lane, &state->detail);
    ++repaired;
  }
  return repaired;
}

// Of so many blocks one may bend farther than what makes the steps of wisps finer: in thousands of
// guides some always do.
constexpr int kFewBlocks = 50;

// One step of a head whose wisps meet. Returns how many strands had to be put to rest.
int AdvanceAmongWisps(const groom::Groom& groom, const StepDrive& drive, const WindField& wind,
                      HeadState* state, exec::WorkerPool& pool, float* bend) {
  thread_local std::vector<Drive> own_drives;
  thread_local std::vector<uint32_t> own_failed;
  thread_local std::vector<float> own_bends;
  std::vector<Drive>& drives = own_drives;
  const int blocks = static_cast<int>(groom.batch.blocks().size());
  drives.assign(wind.turbulent() ? blocks : 1, drive.rows);
  if (wind.turbulent()) {
    pool.ParallelFor(blocks, kBlocksPerPiece, [&](int first, int last) {
      for (int i = first; i < last; ++i) {
        SetEddies(groom, groom.batch.blocks()[i], drive, wind, &drives[i]);
      }
    });
  }
  const double dt = drive.rows[rod::layout::kDuration].lane[0];
  StepAmongWisps(groom, {drives, drive.bodies, drive.surprise, dt}, state->guides, &state->contact,
                 pool, &own_failed, &own_bends);
  for (float& each : own_bends) each = each <= 1 ? each : 1;  // What is no number, too.
  const auto worst = own_bends.end() - 1 - blocks / kFewBlocks;
  std::nth_element(own_bends.begin(), worst, own_bends.end());
  *bend = std::max(*bend, *worst);
  // What failed says nothing of how it bent.
  if (std::ranges::max(own_failed) != 0) *bend = std::max(*bend, 2 * kLargestWispBend);
  int repaired = 0;
  for (int i = 0; i < blocks; ++i) repaired += Repair(groom, i, own_failed[i], state);
  return repaired;
}

// All given steps of block `i`. Returns how many strands had to be put to rest; nothing, amid the
// steps, where some had to but may not.
std::optional<int> AdvanceBlock(const groom::Groom& groom, int i, std::span<const StepDrive> drives,
                                const WindField& wind, bool repairs, HeadState* state,
                                float* bend) {
  const rod::Batch<float>::Block& block = groom.batch.blocks()[i];
  Drive windy;
  int repaired = 0;
  for (const StepDrive& drive : drives) {
    if (wind.turbulent()) {
      windy = drive.rows;
      SetEddies(groom, block, drive, wind, &windy);
    }
    const uint32_t failed =
        StepAtLevel(groom, i, drive, wind.turbulent() ? windy : drive.rows, state, bend);
    if (failed != 0 && !repairs) return std::nullopt;
    repaired += Repair(groom, i, failed, state);
  }
  return repaired;
}

// Of the next steps, after steps that bent so far; kFinest at most, whatever these were.
int NextFineness(int fineness, float bend, float largest) {
  if (bend > largest) return std::min(kFinest, 2 * fineness);
  // Steps twice as long bend four times as far.
  return std::min(kFinest, bend < largest / 8 ? std::max(1, fineness / 2) : fineness);
}

// All given steps of a block among bodies, which are `fineness` times as many as a coarse one
// makes. Returns how many times as many it must make instead, and is then as it was; 0 when done.
int AdvanceAmongBodies(const groom::Groom& groom, int i, int fineness,
                       std::span<const StepDrive> drives, const WindField& wind, HeadState* state,
                       std::atomic<int>* repaired) {
  thread_local std::vector<rod::Row<float>> moving_before, touched_before;
  const Rows moving = MovingRows(groom, i, state);
  // What was seen stays true.
  const Rows touched = TouchedBy(i, &state->contact);
  if (fineness < kFinest) {
    moving_before.assign(moving.begin(), moving.end());
    touched_before.assign(touched.begin(), touched.end());
  }
  float bend = 0;
  int& own = state->contact.blocks[i].fineness;
  const std::optional<int> put_to_rest =
      AdvanceBlock(groom, i, drives, wind, fineness == kFinest, state, &bend);
  if (!put_to_rest || (bend > kLargestBend && fineness < kFinest)) {
    std::ranges::copy(moving_before, moving.begin());
    std::ranges::copy(touched_before, touched.begin());
    return own = 2 * fineness;
  }
  *repaired += *put_to_rest;
  own = NextFineness(fineness, bend, kLargestBend);
  return 0;
}

// The part of Advance that is about rods. Returns how many had to be put to rest.
int AdvanceRods(const groom::Groom& groom, const Movement& movement, const Environment& environment,
                HeadState* state, exec::WorkerPool& pool) {
  const bool bodies = state->contact.bodies != nullptr;
  const bool wisps = bodies && state->contact.bodies->wisps;
  // Wisps meet at points that a level of detail would change.
  const bool detail = environment.detail_tolerance > 0 && state->detail.levels && !wisps;
  if (!detail) StopDetail(groom, state);
  thread_local std::vector<StepDrive> own_drives;
  std::vector<StepDrive>& drives = own_drives;
  const WindField wind(environment.wind, environment.wind_variation);
  const int steps = StepCount(movement);
  const int blocks = static_cast<int>(groom.batch.blocks().size());
  if (detail) {
    const Eigen::Quaterniond turn = movement.target.q * state->pose.q.conjugate();
    state->detail.velocity = (movement.target.p - state->pose.p) / movement.duration;
    state->detail.spin = math::RotationVector(turn) / movement.duration;
  }
  std::atomic<int> repaired = 0;
  const rod::ClampMotion whole{state->pose, movement.target, movement.duration};
  const int coarsest = bodies ? FinenessFor(state->contact, movement.bodies, whole, steps) : 1;
  // Steps that a block has to make of one in this round; 0 when it is done.
  thread_local std::vector<int> own_due;
  std::vector<int>& due = own_due;
  for (int begin = 0; begin < steps; begin += kStepsAtOnce) {
    const int end = std::min(steps, begin + kStepsAtOnce);
    due.assign(blocks, wisps ? std::max(coarsest, state->contact.fineness) : coarsest);
    for (int i = 0; bodies && !wisps && i < blocks; ++i) {
      due[i] = std::max(coarsest, state->contact.blocks[i].fineness);
    }
    for (int fineness = 1; fineness <= kFinestOfWisps; fineness *= 2) {
      if (std::ranges::find(due, fineness) == due.end()) continue;
      SetDrives(*state, movement, steps * fineness, begin * fineness, end * fineness, environment,
                wind, &drives);
      const std::span<const StepDrive> now = std::span(drives).first((end - begin) * fineness);
      if (wisps) {
        float bend = 0;
        for (const StepDrive& drive : now) {
          repaired += AdvanceAmongWisps(groom, drive, wind, state, pool, &bend);
        }
        state->contact.fineness = NextFineness(fineness, bend, kLargestWispBend);
        break;
      }
      pool.ParallelFor(blocks, kBlocksPerPiece, [&](int first, int last) {
        for (int i = first; i < last; ++i) {
          if (due[i] != fineness) continue;
          if (bodies) {
            due[i] = AdvanceAmongBodies(groom, i, fineness, now, wind, state, &repaired);
          } else {
            repaired += *AdvanceBlock(groom, i, now, wind, true, state, nullptr);
          }
          if (detail && end == steps && (!bodies || due[i] == 0)) {
            FinishBlock(groom, i, movement, environment.detail_tolerance, state);
          }
        }
      });
    }
  }
  if (bodies) {
    Remember(whole, &state->contact);
  }
  return repaired;
}

}  // namespace

int StepCount(const Movement& movement) {
  // The tolerance keeps a duration of one longest step, rounded up, whole.
  const double longest = std::ceil(movement.duration / kLongestStep - 1e-6);
  return std::max(movement.substeps, static_cast<int>(longest));
}

HeadState AtRest(const groom::Groom& groom, const math::Pose& pose) {
  HeadState state;
  state.pose = pose;
  state.guides.resize(groom.batch.state_rows());
  for (int guide = 0; guide < groom.guide_count(); ++guide) PutToRest(groom, guide, &state);
  return state;
}

void Reset(const groom::Groom& groom, HeadState* state) {
  for (Detail::Block& block : state->detail.blocks) block.level = 0, block.calm = 0;
  state->transition = {};
  if (state->beams.active) PutBeamsToRest(state->pose, &state->beams);
  if (state->contact.bodies != nullptr) {
    ResetContact(state);
    return;
  }
  for (int guide = 0; guide < groom.guide_count(); ++guide) PutToRest(groom, guide, state);
}

std::vector<double> Coordinates(const groom::Groom& groom, const HeadState& state) {
  std::vector<double> coordinates(groom.coordinate_count());
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    groom.batch.GetCoordinates(
        guide, state.guides,
        std::span(coordinates)
            .subspan(groom.first_coordinate[guide], groom.guides[guide].coordinate_count()));
  }
  return coordinates;
}

void Teleport(const groom::Groom& groom, const math::Pose& pose, HeadState* state) {
  const Eigen::Quaterniond turn = pose.q * state->pose.q.conjugate();
  groom.batch.RotateVelocities(turn.toRotationMatrix(), state->guides);
  for (int i = 0; i < std::ssize(groom.batch.blocks()); ++i) {
    if (LevelOf(*state, i) == 0) continue;
    state->detail.levels->At(i, LevelOf(*state, i))
        .batch.RotateVelocities(turn.toRotationMatrix(), CoarseState(groom, i, &state->detail));
  }
  TurnBeams(turn, &state->beams);
  state->detail.velocity = turn * state->detail.velocity;
  state->detail.spin = turn * state->detail.spin;
  const math::Pose moved = pose * state->pose.Inverse();
  for (math::Pose& body : state->contact.moving) body = moved * body;
  state->contact.velocity = turn * state->contact.velocity;
  state->contact.spin = turn * state->contact.spin;
  state->pose = pose;
}

HeadState FullDetail(const groom::Groom& groom, HeadState state) {
  StopDetail(groom, &state);
  return state;
}

int SteppedElements(const groom::Groom& groom, const HeadState& state) {
  if (state.beams.active) return groom.guide_count() * state.beams.beams->segments;
  int elements = 0;
  for (int i = 0; i < std::ssize(groom.batch.blocks()); ++i) {
    const auto& block = groom.batch.blocks()[i];
    const int level = LevelOf(state, i);
    elements +=
        block.count * (level == 0 ? block.elements : state.detail.levels->At(i, level).elements);
  }
  return elements;
}

StepReport Advance(const groom::Groom& groom, const Movement& movement,
                   const Environment& environment, HeadState* state, exec::WorkerPool& pool) {
  MANE_CHECK(movement.duration > 0 && movement.substeps >= 1);
  MANE_CHECK(state->guides.size() == groom.batch.state_rows());
  MANE_CHECK(movement.bodies.empty() || movement.bodies.size() == state->contact.moving.size());
  if ((movement.target.p - state->pose.p).norm() > kFastestHead * movement.duration) {
    Teleport(groom, movement.target, state);
  }
  int repaired = 0;
  if (state->beams.active) {
    repaired = AdvanceBeams(movement, environment, state, pool);
  } else {
    repaired = AdvanceRods(groom, movement, environment, state, pool);
  }
  RememberMovement(movement, state);
  state->pose = movement.target;
  if (!movement.bodies.empty()) {
    state->contact.moving.assign(movement.bodies.begin(), movement.bodies.end());
  }
  state->time += movement.duration;
  if (Remaining(state->transition, state->time) == 0) state->transition = {};
  return {repaired};
}

}  // namespace mane::head
