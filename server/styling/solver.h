#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "base/cancelled.h"
#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/sampler.h"
#include "styling/density_field.h"
#include "styling/force_field.h"
#include "styling/hairstyle.h"
#include "styling/obstacles.h"
#include "styling/styler.h"

namespace mane::styling {

/// What deforms the outlines of master strands. All valid: what a caller may get wrong is checked
/// by Validate (force_field.h, constraint.h) and its like.
struct SolverInput {
  std::vector<groom::ScalpPoint> roots;           ///< (wisps)
  std::vector<Eigen::Vector3d> first_directions;  ///< q0 of first segments, unit, (wisps).
  std::vector<float> strands;  ///< That the segment leaving a joint has, master too, (joints).
  std::vector<float> radii;    ///< Of the wisp there [m], (joints).

  std::vector<FieldTerm> field;
  double bending_stiffness = 0.5;
  double density_threshold = 0.9;
  double strand_cross_section = 7e-8;  ///< [m^2]
  double cell = 0.008;                 ///< [m]; larger where BoxOver says so.

  std::vector<ConstraintQueue> queues;
  std::vector<std::vector<uint32_t>> selected;  ///< Wisps of each queue, ascending, (queues).

  Obstacles obstacles;
};

/// How it went.
struct SolverReport {
  int64_t segments = 0;
  int64_t dense_segments = 0;  ///< That found no direction in which (6) does not hold.
  int64_t tries = 0;           ///< Directions looked at.
  int64_t nodes = 0;           ///< Of the density grid, looked at for deposits.
  std::vector<std::vector<ConstraintReport>> constraints;  ///< Per queue.
};

struct Deformed {
  SolverReport report;
  std::shared_ptr<const DensityField> density;  ///< Of all hair and obstacles.
};

/// Share of the segments that have been laid, in [0, 1]; called now and then by the caller's
/// thread.
using SolverProgress = std::function<void(double)>;

/// Algorithm 1 of [CK05] with constraints: fills `outline`, `frames` and `points` of `masters`,
/// whose details, lengths and joints are set; every wisp has two joints or more. solver.md tells
/// the steps and where they depart from the paper.
///
/// Segments have the length of `masters` exactly. No joint but roots and no control point is nearer
/// to an obstacle than a millimetre, or a quarter of a cell if that is less: joints turn out of
/// them, details are shortened.
///
/// @return kCancelled soon after `cancelled`, which is asked every 64 segments, says so.
/// Cost: linear in segments, some microsecond each, and in nodes of the grid. The same bits for any
/// number of workers.
[[nodiscard]] Result<Deformed> Deform(const SolverInput& input, Masters* masters,
                                      const base::Cancelled& cancelled,
                                      const SolverProgress& progress, exec::WorkerPool* pool);

}  // namespace mane::styling
