#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <span>
#include <vector>

#include "groom/groom.h"
#include "head/kernels.h"
#include "math/rigid.h"
#include "rod/batch.h"

namespace mane::head {

/// One worker's memory for points of strands.
struct PointScratch {
  std::vector<rod::Row<float>> positions;
  std::vector<Eigen::Vector3f> points;
};

/// Calls visit(guide, points) for every guide of a block of rods: its points at equal arc length,
/// root and tip included, under `clamp` [m].
///
/// @param guides  as HeadState::guides.
template <typename Visit>
void ForRodPoints(const groom::Groom& groom, const rod::Batch<float>::Block& block,
                  std::span<const rod::Row<float>> guides, const math::Pose& clamp, int points,
                  PointScratch& scratch, const Visit& visit) {
  std::array<rod::Row<float>, rod::layout::kPoseRows> pose;
  rod::SetPose<float>(clamp, 0, rod::layout::kLanes, pose);
  scratch.positions.resize(static_cast<size_t>(3) * points);
  scratch.points.resize(points);
  Kernels()
      .Of(block.kind)
      .sample(block.elements, groom.batch.constants(block), pose[0].lane, guides[block.state].lane,
              points, scratch.positions[0].lane);
  for (int lane = 0; lane < block.count; ++lane) {
    const rod::Row<float>* row = scratch.positions.data();
    for (Eigen::Vector3f& point : scratch.points) {
      point = {row[0].lane[lane], row[1].lane[lane], row[2].lane[lane]};
      row += 3;
    }
    visit(block.strands[lane], std::span(scratch.points));
  }
}

}  // namespace mane::head
