#pragma once

#include <optional>
#include <span>
#include <vector>

#include "beam/motion.h"

namespace mane::beam::fixtures {

/// One hair in double precision, segment by segment, after beam.md; shares no code with the
/// kernels. Directions and steps are world; with Equations::kPolar, steps are those of the angles.
struct ReferenceHair {
  std::vector<Eigen::Vector3d> e;
  std::vector<Eigen::Vector3d> step;  ///< delta (kAcross).
  struct Angles {
    double t, f, t_step, f_step;
  };
  std::vector<Angles> angles;  ///< (kPolar)
};

/// A hair at these directions with these last steps [rad], of which only what is across counts.
[[nodiscard]] ReferenceHair Begin(std::span<const Eigen::Vector3d> directions,
                                  std::span<const Eigen::Vector3d> steps);

/// One step of hair `index` of a batch.
///
/// @param hull  the lifted one of the settings (Lifted); empty for none.
void ReferenceStep(const MotionHair& hair, int index, const Eigen::Vector3d& gravity,
                   const MotionSettings& settings, const MotionDrive& drive,
                   const Eigen::Vector3d& wind, const std::optional<Hull>& hull,
                   ReferenceHair* state);

/// Last steps [rad] as vectors across the directions.
[[nodiscard]] std::vector<Eigen::Vector3d> StepsOf(const MotionSettings& settings,
                                                   const ReferenceHair& state);

}  // namespace mane::beam::fixtures
