#pragma once

#include <filesystem>

#include "base/result.h"

namespace mane::app {

/// Makes `path` a file with the line `port`. Whoever waits for the file never sees a part of it.
/// kUnavailable when the file cannot be written.
[[nodiscard]] Result<void> WritePortFile(const std::filesystem::path& path, int port);

}  // namespace mane::app
