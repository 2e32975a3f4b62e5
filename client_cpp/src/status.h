#pragma once

#include <grpcpp/support/status.h>

#include "mane/error.h"

namespace mane::inline client {

/// The error that a failed call's status describes; the field and its sentence come from the first
/// violation of a google.rpc.BadRequest detail when there is one. `status` must not be OK.
Error ToError(const grpc::Status& status);

}  // namespace mane::inline client
