#pragma once

#include <grpcpp/support/byte_buffer.h>

#include <google/protobuf/message_lite.h>

#include "base/result.h"

namespace mane::rpc {

/// Messages of raw streaming methods. gRPC's typed callback streams cannot tell a message that does
/// not parse from the client's half-close; parsing here can.

/// kInvalidArgument when `bytes` are not a valid `message`.
Result<void> Parse(grpc::ByteBuffer* bytes, google::protobuf::MessageLite* message);

[[nodiscard]] grpc::ByteBuffer Serialize(const google::protobuf::MessageLite& message);

}  // namespace mane::rpc
