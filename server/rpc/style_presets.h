#pragma once

#include "mane/v1/style.pb.h"

namespace mane::rpc {

/// Shipped styles, in the order in which they are shown.
[[nodiscard]] const v1::ListStylePresetsResponse& StylePresets();

}  // namespace mane::rpc
