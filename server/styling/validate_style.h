#pragma once

#include <string>

#include "base/result.h"
#include "styling/hairdressing.h"
#include "styling/style.h"

namespace mane::styling {

/// INVALID_ARGUMENT for the first part of a style that is out of its range, named as mane.v1.Style
/// spells it below `field`. Ranges stand in proto/mane/v1/style.proto.
///
/// What needs the scalp is not looked at: a density that is 0 on all of it, queues that no wisp or
/// several select, points inside the head. That shows when the style is applied.
[[nodiscard]] Result<void> ValidateStyle(const Style& style, const std::string& field);

/// The same of an operation on `style`, named as mane.v1.HairdressingOperation spells it.
[[nodiscard]] Result<void> ValidateOperation(const Operation& operation, const Style& style,
                                             const std::string& field);

}  // namespace mane::styling
