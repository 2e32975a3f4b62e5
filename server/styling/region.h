#pragma once

#include <cstdint>
#include <string>

#include "base/result.h"
#include "styling/chart.h"
#include "styling/style.h"

namespace mane::styling {

/// Whether a wisp is in a valid region: its root `point`, head frame [m], and its number.
/// O(half-spaces + log wisps).
[[nodiscard]] bool Contains(const Region& region, const ScalpChart& chart,
                            const Eigen::Vector3d& point, uint32_t wisp);

/// INVALID_ARGUMENT that names a part of `field`, where it is out of range or leaves nothing:
/// intervals without width, half-spaces that exclude each other, a mask nowhere above 0.5, numbers
/// that do not increase or are not below `wisp_count`. Bounds include themselves. Normals may have
/// any length in [1e-6, 1e6]: their direction counts.
///
/// A valid region may still hold no wisp of a scalp: that shows when the wisps are known.
[[nodiscard]] Result<void> Validate(const Region& region, const std::string& field, int wisp_count);

}  // namespace mane::styling
