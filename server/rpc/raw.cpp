#include "rpc/raw.h"

#include <grpcpp/support/proto_buffer_reader.h>

#include <string>

namespace mane::rpc {

Result<void> Parse(grpc::ByteBuffer* bytes, google::protobuf::MessageLite* message) {
  grpc::ProtoBufferReader reader(bytes);
  if (!reader.status().ok() || !message->ParseFromZeroCopyStream(&reader)) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("{} bytes do not parse as {}", bytes->Length(), message->GetTypeName()), ""};
  }
  return {};
}

grpc::ByteBuffer Serialize(const google::protobuf::MessageLite& message) {
  grpc_slice slice = grpc_slice_malloc(message.ByteSizeLong());
  message.SerializeWithCachedSizesToArray(GRPC_SLICE_START_PTR(slice));
  const grpc::Slice owned(slice, grpc::Slice::STEAL_REF);
  return grpc::ByteBuffer(&owned, 1);
}

}  // namespace mane::rpc
