#pragma once

#include <Eigen/Core>

#include <memory>
#include <span>
#include <vector>

#include "groom/groom.h"
#include "head/levels.h"
#include "math/rigid.h"

namespace mane::head {

/// Which blocks of a head are stepped with fewer elements than they have, and what is shown beyond
/// what these can hold (rod.md, Detail). What is shown, angles and rates of all elements, lies in
/// HeadState::guides for every block; the velocities there are old where a block is coarse.
struct Detail {
  struct Block {
    int level = 0;    ///< 0 is full detail.
    double calm = 0;  ///< For so long a coarser level would have done [s].
    size_t first;     ///< In `rows`: coarse state, then offsets and their rates, (N x 3) each.
  };
  std::shared_ptr<const Levels> levels;  ///< Null before StartDetail: all is at full detail.
  std::vector<Block> blocks;
  std::vector<rod::Row<float>> rows;
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Of the clamp in the last step [m/s].
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();      ///< [rad/s]
};

using Rows = std::span<rod::Row<float>>;

/// Lets blocks be coarsened from the next Advance on, all being at full detail at first. Allocates.
///
/// @param levels  of `groom`, not null.
void StartDetail(const groom::Groom& groom, std::shared_ptr<const Levels> levels, Detail* detail);

/// State of a coarse block, as its level's batch packs it.
[[nodiscard]] Rows CoarseState(const groom::Groom& groom, int block, Detail* detail);

/// Puts one lane of a coarse block to rest; what is shown follows with the next ShowBlock.
void RestLane(const groom::Groom& groom, int block, int lane, Detail* detail);

/// After the steps of a frame of `duration` [s]: what a coarse block shows.
void ShowBlock(const groom::Groom& groom, int block, double duration, Rows guides, Detail* detail);

/// Takes a block to a level, 0 to levels->Count(block). What it shows stays, up to rounding, and so
/// do the rates.
///
/// @param clamp  the head's pose.
void SwitchBlock(const groom::Groom& groom, int block, int level, const math::Pose& clamp,
                 Rows guides, Detail* detail);

/// Level that suits what a block shows: one finer than now where its present level bends too much
/// for `tolerance` [m], one coarser where the next would have done for a while.
[[nodiscard]] int ChooseLevel(const groom::Groom& groom, int block, double duration,
                              double tolerance, Rows guides, Detail* detail);

}  // namespace mane::head
