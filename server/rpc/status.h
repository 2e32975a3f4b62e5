#pragma once

#include <grpcpp/support/status.h>

#include "base/result.h"

namespace mane::rpc {

/// The gRPC status of an error: its code, its sentence, and, where a field is at fault, a
/// google.rpc.BadRequest detail that names it.
[[nodiscard]] grpc::Status ToStatus(const Error& error);

/// OK or the error's status.
template <typename T>
[[nodiscard]] grpc::Status ToStatus(const Result<T>& result) {
  return result ? grpc::Status::OK : ToStatus(result.error());
}

}  // namespace mane::rpc
