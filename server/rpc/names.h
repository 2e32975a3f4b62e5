#pragma once

#include <string>
#include <string_view>

#include "base/result.h"

namespace mane::rpc {

/// The id in a resource name `<collection>/{id}`; kInvalidArgument names `field` when it is none.
Result<std::string> ParseName(const std::string& name, std::string_view collection,
                              const std::string& field);

/// kInvalidArgument unless `id` is `[a-z0-9]([a-z0-9-]{0,61}[a-z0-9])?`.
Result<void> CheckId(const std::string& id, const std::string& field);

/// 16 random characters, a valid id.
[[nodiscard]] std::string RandomId();

/// kInvalidArgument when `text` is longer than `max_bytes`. (That it is UTF-8 protobuf has
/// checked.)
Result<void> CheckText(const std::string& text, size_t max_bytes, const std::string& field);

}  // namespace mane::rpc
