#pragma once

#include <Eigen/Core>

#include <array>
#include <span>

#include "styling/density_field.h"

namespace mane::styling {

/// A segment of a wisp that lies in the density field.
struct Laid {
  DensityField::Segment segment;
  float scale = 0;  ///< DensityField::Scale.
};

/// How (6) sees a segment that a wisp might lay.
struct Crowding {
  /// Largest rho + rho_Delta - tau among the points that it occupies; above 0 it is a collision.
  float excess = 0;
  /// Gradient of rho at that point [1/m].
  Eigen::Vector3f slope = Eigen::Vector3f::Zero();
};

/// (6) with what constraints make of it (D9): hair counts as `hair_share` of what it is.
struct CrowdingTest {
  const DensityField& density;
  float tau;
  float hair_share;           ///< 1, or 1 - w where a constraint presses hair together.
  std::span<const Laid> own;  ///< The wisp's segments near by, whose density does not count.

  /// @param scale  of `next`, DensityField::Scale.
  [[nodiscard]] Crowding Of(const DensityField::Segment& next, float scale) const;
};

}  // namespace mane::styling
