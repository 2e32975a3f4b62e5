#pragma once

#include "app/options.h"
#include "base/result.h"
#include "rpc/server.h"

namespace mane::app {

/// What the server needs of `options`, with certificate, key and token read from their files.
/// kInvalidArgument for an empty, short or unprintable token, kUnavailable for an unreadable file;
/// both name the setting. No message holds a secret.
[[nodiscard]] Result<rpc::ServerOptions> ToServerOptions(const Options& options);

}  // namespace mane::app
