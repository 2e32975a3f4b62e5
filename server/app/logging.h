#pragma once

#include <string>

namespace mane::app {

/// Sends spdlog's default logger, and what gRPC logs, to the standard error stream: one line an
/// event, `time=... level=... event=... key=value ...`. `level` is `debug`, `info`, `warning` or
/// `error`. Call once, before other threads log.
void SetUpLogging(const std::string& level);

}  // namespace mane::app
