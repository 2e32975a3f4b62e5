#pragma once

#include <grpcpp/security/server_credentials.h>

#include <memory>

#include "rpc/server.h"

namespace mane::rpc {

/// Plain text, or TLS; with a token, calls that do not carry it are refused with UNAUTHENTICATED.
[[nodiscard]] std::shared_ptr<grpc::ServerCredentials> MakeCredentials(
    const ServerOptions& options);

}  // namespace mane::rpc
