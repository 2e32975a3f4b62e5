#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "mane/v1/style.pb.h"
#include "styling/hairdressing.h"
#include "styling/style.h"

namespace mane::rpc {

/// A style document to the domain: what is unset gets its default, PNG files are decoded, and its
/// operations are worked in. What only the encoding can get wrong, and how much there may be of
/// something, is checked here; ranges by styling::ValidateStyle, which is called at the end.
///
/// @param field  path of the message, such as `header.style`. @return kInvalidArgument naming the
///   first field that is wrong; of what operations became, `operations[i]`.
[[nodiscard]] Result<styling::Style> ToStyle(const v1::Style& message, const std::string& field);

}  // namespace mane::rpc
