#include "head/head.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <span>

#include "base/check.h"
#include "head/kernels.h"
#include "rod/gauss.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Drive = std::array<rod::Row<float>, rod::layout::kDriveRows>;

// Blocks advanced in one piece by one worker: a piece takes longer than handing it over.
constexpr int kBlocksPerPiece = 4;
// Steps that a piece makes at a time, whose drives are at hand together.
constexpr int kStepsAtOnce = 16;

void PutToRest(const groom::Groom& groom, int guide, HeadState* state) {
  thread_local std::vector<Vector3d> theta, zero;
  const int first = groom.first_element[guide], N = groom.first_element[guide + 1] - first;
  theta.assign(groom.rest_theta.begin() + first, groom.rest_theta.begin() + first + N);
  zero.assign(static_cast<size_t>(N) * rod::kGaussPoints, Vector3d::Zero());
  groom.batch.SetStrand(guide, {theta, std::span(zero).first(N), zero}, state->guides);
}

// Steps [begin, end) of `steps` equal ones along `movement`, which starts at `from`.
void SetDrives(const math::Pose& from, const Movement& movement, int steps, int begin, int end,
               const Environment& environment, std::vector<Drive>* drives) {
  drives->resize(kStepsAtOnce);
  const auto pose = [&](int i) {
    return i == steps ? movement.target
                      : math::Interpolate(from, movement.target, static_cast<double>(i) / steps);
  };
  for (int i = begin; i < end; ++i) {
    const rod::ClampMotion motion{pose(i), pose(i + 1), movement.duration / steps};
    rod::SetDrive<float>(motion, environment, 0, rod::layout::kLanes, (*drives)[i - begin]);
  }
}

// All given steps of one block. Returns how many strands had to be put to rest.
int AdvanceBlock(const groom::Groom& groom, const rod::Batch<float>::Block& block,
                 std::span<const Drive> drives, HeadState* state) {
  thread_local rod::BatchScratch scratch;
  int repaired = 0;
  for (const Drive& drive : drives) {
    uint32_t failed =
        rod::StepBlock<float>(Kernels(), groom.batch, block, drive, state->guides, scratch);
    for (int lane = 0; failed != 0 && lane < block.count; ++lane) {
      if ((failed >> lane & 1) == 0) continue;
      PutToRest(groom, block.strands[lane], state);
      ++repaired;
    }
  }
  return repaired;
}

}  // namespace

int StepCount(const Movement& movement) {
  // The tolerance keeps a duration of one longest step, rounded up, whole.
  const double longest = std::ceil(movement.duration / kLongestStep - 1e-6);
  return movement.substeps * std::max(1, static_cast<int>(longest));
}

HeadState AtRest(const groom::Groom& groom, const math::Pose& pose) {
  HeadState state;
  state.pose = pose;
  state.guides.resize(groom.batch.state_rows());
  for (int guide = 0; guide < groom.guide_count(); ++guide) PutToRest(groom, guide, &state);
  return state;
}

void Reset(const groom::Groom& groom, HeadState* state) { *state = AtRest(groom, state->pose); }

std::vector<Vector3d> Angles(const groom::Groom& groom, const HeadState& state) {
  std::vector<Vector3d> theta(groom.element_count());
  for (int guide = 0; guide < groom.guide_count(); ++guide) {
    groom.batch.GetAngles(guide, state.guides,
                          std::span(theta).subspan(groom.first_element[guide]));
  }
  return theta;
}

void Teleport(const groom::Groom& groom, const math::Pose& pose, HeadState* state) {
  const Eigen::Quaterniond turn = pose.q * state->pose.q.conjugate();
  groom.batch.RotateVelocities(turn.toRotationMatrix(), state->guides);
  state->pose = pose;
}

StepReport Advance(const groom::Groom& groom, const Movement& movement,
                   const Environment& environment, HeadState* state, exec::WorkerPool& pool) {
  MANE_CHECK(movement.duration > 0 && movement.substeps >= 1);
  MANE_CHECK(state->guides.size() == groom.batch.state_rows());
  thread_local std::vector<Drive> own_drives;
  std::vector<Drive>& drives = own_drives;
  const int steps = StepCount(movement);
  const auto blocks = groom.batch.blocks();
  std::atomic<int> repaired = 0;
  for (int begin = 0; begin < steps; begin += kStepsAtOnce) {
    const int end = std::min(steps, begin + kStepsAtOnce);
    SetDrives(state->pose, movement, steps, begin, end, environment, &drives);
    const std::span<const Drive> now = std::span(drives).first(end - begin);
    pool.ParallelFor(static_cast<int>(blocks.size()), kBlocksPerPiece, [&](int first, int last) {
      for (int i = first; i < last; ++i) repaired += AdvanceBlock(groom, blocks[i], now, state);
    });
  }
  state->pose = movement.target;
  return {repaired};
}

}  // namespace mane::head
