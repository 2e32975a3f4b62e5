#pragma once

#include <Eigen/Core>

#include <span>

#include "groom/presets.h"
#include "groom/validate.h"

namespace mane::groom {

/// Writes section, material and damping of a hair type.
void SetProperties(const Preset& preset, GuideDescription* description);

/// Writes natural (twist, curvature 1, curvature 2) [rad/m] of every element, (N).
void SetNatural(std::span<const Eigen::Vector3d> natural, GuideDescription* description);

}  // namespace mane::groom
