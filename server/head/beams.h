#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "beam/motion.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/bodies.h"
#include "head/model.h"
#include "rod/batch.h"

namespace mane::head {

/// A groom's guides as beams (beam.md): what the motion of every head of it needs that shares the
/// options. Immutable; a function of its arguments.
///
/// A guide's polyline has its nodes on the guide's rest shape, or that to which it settled among
/// bodies, all segments being equally long: curls within a segment are lost, so that the polyline
/// is shorter than the hair, and never longer. It weighs what the hair does. The few guides that
/// the hull does not leave outside (HullOf) rest where it turns them out (B6).
struct Beams {
  BeamOptions options;                 ///< As they were asked for.
  int segments = 0;                    ///< k of every guide (SegmentsOf).
  beam::MotionBatch<float> batch;      ///< Hair i is guide i.
  std::vector<double> segment_length;  ///< d [m], (guides).
  /// Where nodes but roots are on guides, of CurvePoints points (head/polyline.h),
  /// (guides x segments).
  std::vector<double> places;
  std::vector<Eigen::Vector3d> directions;  ///< At rest, unit, head frame, (guides x segments).
  /// Coordinates of that shape, as groom::Groom::rest.
  std::vector<double> coordinates;
  /// Roots, head frame [m], (blocks).
  std::vector<std::array<rod::Row<float>, 3>> roots;
  /// State of the batch, still, on an upright head.
  std::vector<rod::Row<float>> rest;

  [[nodiscard]] std::span<const Eigen::Vector3d> rest_of(int guide) const {
    return std::span(directions).subspan(static_cast<size_t>(guide) * segments, segments);
  }
};

/// @param bodies  of the groom; null where hair meets nothing.
[[nodiscard]] std::shared_ptr<const Beams> MakeBeams(const groom::Groom& groom,
                                                     const Bodies* bodies,
                                                     const BeamOptions& options,
                                                     exec::WorkerPool& pool);

/// Segments of each guide: those of the options, or where they leave it open, one for each radian
/// that guides turn by at rest (Groom::turning), but 16 to 64. So segments are shorter than curls
/// are wide.
[[nodiscard]] int SegmentsOf(const groom::Groom& groom, const BeamOptions& options);

/// Points of a strand through which beams of so many segments follow it.
[[nodiscard]] int CurvePoints(int segments);

}  // namespace mane::head
