#pragma once

#include "app/options.h"
#include "base/result.h"

namespace mane::app {

/// Asks the server that these options would start, through grpc.health.v1, whether it serves. An
/// unspecified address such as 0.0.0.0 is asked on loopback. With TLS only the server's own
/// certificate is trusted, whatever name it holds, and the token is sent along.
///
/// kUnavailable when it does not answer SERVING within 5 s; ToServerOptions' errors for a
/// certificate or token that cannot be read.
[[nodiscard]] Result<void> CheckHealth(const Options& options);

}  // namespace mane::app
