#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"
#include "styling/chart.h"
#include "styling/hairstyle.h"
#include "styling/style.h"

namespace mane::styling {

/// The wisps that each queue leads, in increasing order.
///
/// A queue that takes a share of its selection gets the wisps of one of `share_count` parts that
/// are equal to a wisp, by azimuth: counter-clockwise seen from above, from the side where the
/// selection has its widest gap. So the parts of hair at the back are its left, middle and right.
///
/// @param field  path of the style. @return kInvalidArgument naming `<field>.queues[i].selection`
///   where it holds no wisp of this head, or one that an earlier queue leads.
[[nodiscard]] Result<std::vector<std::vector<uint32_t>>> SelectWisps(
    const std::vector<ConstraintQueue>& queues, const Roots& roots, const ScalpChart& chart,
    const std::string& field);

}  // namespace mane::styling
