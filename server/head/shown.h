#pragma once

#include <Eigen/Core>

#include <span>

#include "base/check.h"
#include "head/head.h"
#include "head/points.h"

namespace mane::head {

/// Blocks of guides in which a head's shape is shown, whatever its model.
[[nodiscard]] int ShownBlocks(const groom::Groom& groom, const HeadState& state);

/// Points of a beam at equal distances along its polyline, root and tip included.
///
/// @param nodes  (segments + 1).
void PointsOfBeam(std::span<const Eigen::Vector3f> nodes, std::span<Eigen::Vector3f> points);

/// Brings `points` of a guide, from its model's own shape to what the head shows: each vector to
/// the next point gains its part of the transition, but is made no longer than `longest` [m].
///
/// @param turn     from the axes of offsets to those of points.
/// @param offsets  (points - 1).
void AddOffsets(double remaining, const Eigen::Matrix3f& turn,
                std::span<const Eigen::Vector3f> offsets, float longest,
                std::span<Eigen::Vector3f> points);

/// Calls visit(guide, points) for every guide of a block: its model's own shape, `points` at equal
/// distances along it, from the head's place in world axes [m].
template <typename Visit>
void ForModelPoints(const groom::Groom& groom, const HeadState& state, int block, int points,
                    PointScratch& scratch, const Visit& visit) {
  if (!state.beams.active) {
    const math::Pose turn{Eigen::Vector3d::Zero(), state.pose.q};
    ForRodPoints(groom, groom.batch.blocks()[block], state.guides, turn, points, scratch, visit);
    return;
  }
  const Beams& beams = *state.beams.beams;
  const int nodes = beams.segments + 1;
  thread_local std::vector<Eigen::Vector3f> own_nodes;
  own_nodes.resize(nodes);
  scratch.positions.resize(static_cast<size_t>(3) * nodes);
  scratch.points.resize(points);
  beams.batch.Nodes(BeamKernels(), block, state.pose, state.beams.rows, scratch.positions);
  for (int lane = 0; lane < simd::kLanes; ++lane) {
    const int guide = block * simd::kLanes + lane;
    if (guide >= groom.guide_count()) break;
    const rod::Row<float>* row = scratch.positions.data();
    for (Eigen::Vector3f& node : own_nodes) {
      node = {row[0].lane[lane], row[1].lane[lane], row[2].lane[lane]};
      row += 3;
    }
    PointsOfBeam(own_nodes, scratch.points);
    visit(guide, std::span(scratch.points));
  }
}

/// The same for what the head shows. Where a transition is under way, `points` are its own.
template <typename Visit>
void ForShownPoints(const groom::Groom& groom, const HeadState& state, int block, int points,
                    PointScratch& scratch, const Visit& visit) {
  const Transition& transition = state.transition;
  if (transition.points == 0) {
    ForModelPoints(groom, state, block, points, scratch, visit);
    return;
  }
  MANE_CHECK(points == transition.points);
  const double remaining = Remaining(transition, state.time);
  const Eigen::Matrix3f turn = state.pose.q.toRotationMatrix().cast<float>();
  const auto chords = static_cast<size_t>(points - 1);
  ForModelPoints(
      groom, state, block, points, scratch, [&](int guide, std::span<Eigen::Vector3f> own) {
        const auto longest =
            static_cast<float>(groom.guides[guide].strand.TotalLength() / (points - 1));
        AddOffsets(remaining, turn, std::span(transition.offsets).subspan(guide * chords, chords),
                   longest, own);
        visit(guide, own);
      });
}

}  // namespace mane::head
