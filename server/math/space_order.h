#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

namespace mane::math {

/// Keys that sort points along a curve through space (Morton's: the bits of the coordinates in
/// turn), so that points near each other come near each other in the order, most of them: what
/// works on them in that order finds what it needs in the cache.
///
/// The box around the points has 2^16 cells along its longest side; points of one cell share a key.
/// Of points that are not finite the key is 0.
[[nodiscard]] std::vector<uint64_t> SpaceOrder(std::span<const Eigen::Vector3d> points);

}  // namespace mane::math
