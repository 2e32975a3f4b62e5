#pragma once

#include <Eigen/Core>

#include <span>

#include "beam/hull.h"
#include "beam/style.h"

namespace mane::beam {

/// Where a cut ends a hair: how many segments of it stay, the last of them in part, in [0, k]
/// (beam.md, Cuts). Whether the hair is one of those that the cut is about is the caller's to ask.
///
/// @param nodes           head frame [m], (k + 1).
/// @param segment_length  d [m]
[[nodiscard]] double KeptBy(const Cut& cut, std::span<const Eigen::Vector3f> nodes,
                            double segment_length);

/// Leaves so many segments of a hair: moves the node where it ends to there.
///
/// @param kept   in [0, k]
/// @param hull   the lifted one (Lifted), so that rounding leaves no end inside.
/// @param nodes  head frame [m], (k + 1); changed.
/// @return nodes that stay; 0 where fewer than two would.
[[nodiscard]] int EndHair(double kept, const Hull& hull, std::span<Eigen::Vector3f> nodes);

}  // namespace mane::beam
