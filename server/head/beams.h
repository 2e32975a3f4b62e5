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
/// is shorter than the hair, and never longer. It weighs what the hair does.
struct Beams {
  BeamOptions options;
  beam::MotionBatch<float> batch;           ///< Hair i is guide i.
  std::vector<double> segment_length;       ///< d [m], (guides).
  std::vector<Eigen::Vector3d> directions;  ///< At rest, unit, head frame, (guides x segments).
  /// Coordinates of that shape, as groom::Groom::rest.
  std::vector<double> coordinates;
  /// Roots, head frame [m], (blocks).
  std::vector<std::array<rod::Row<float>, 3>> roots;
  /// State of the batch, still, on an upright head.
  std::vector<rod::Row<float>> rest;

  [[nodiscard]] std::span<const Eigen::Vector3d> rest_of(int guide) const {
    return std::span(directions)
        .subspan(static_cast<size_t>(guide) * options.segments, options.segments);
  }
};

/// @param bodies  of the groom; null where hair meets nothing.
[[nodiscard]] std::shared_ptr<const Beams> MakeBeams(const groom::Groom& groom,
                                                     const Bodies* bodies,
                                                     const BeamOptions& options,
                                                     exec::WorkerPool& pool);

/// Points of a strand through which StrideLength and Stride follow it.
[[nodiscard]] int CurvePoints(const BeamOptions& options);

/// The ellipsoid that beams of `groom` stay out of (B6): its scalp, or the one that is fitted to
/// the scalp's mesh, small enough that all given points are outside; empty where there is no scalp.
[[nodiscard]] std::optional<beam::Hull> HullOf(const groom::Groom& groom,
                                               std::span<const Eigen::Vector3f> outside);

}  // namespace mane::head
