#pragma once

#include <vector>

#include "contact/shape.h"
#include "math/rigid.h"

namespace mane::styling {

/// A solid that hair stays out of.
struct Obstacle {
  contact::BodyShape shape;
  math::Pose pose;  ///< shape -> head frame.
};

/// Head, neck, shoulders: all that hair stays out of.
using Obstacles = std::vector<Obstacle>;

/// Distance to the nearest of `obstacles` and its normal, head frame; a distance of 1e9 m and +Y
/// where there is none.
[[nodiscard]] contact::Distance DistanceTo(const Obstacles& obstacles,
                                           const Eigen::Vector3d& point);

}  // namespace mane::styling
