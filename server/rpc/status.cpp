#include "rpc/status.h"

#include "status.pb.h"

namespace mane::rpc {
namespace {

grpc::StatusCode ToCode(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return grpc::StatusCode::INVALID_ARGUMENT;
    case ErrorCode::kNotFound:
      return grpc::StatusCode::NOT_FOUND;
    case ErrorCode::kAlreadyExists:
      return grpc::StatusCode::ALREADY_EXISTS;
    case ErrorCode::kFailedPrecondition:
      return grpc::StatusCode::FAILED_PRECONDITION;
    case ErrorCode::kResourceExhausted:
      return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case ErrorCode::kCancelled:
      return grpc::StatusCode::CANCELLED;
    case ErrorCode::kUnavailable:
      return grpc::StatusCode::UNAVAILABLE;
    case ErrorCode::kInternal:
      return grpc::StatusCode::INTERNAL;
  }
  return grpc::StatusCode::UNKNOWN;
}

}  // namespace

grpc::Status ToStatus(const Error& error) {
  Status details;
  details.set_code(ToCode(error.code));
  details.set_message(error.message);
  if (!error.field.empty()) {
    BadRequest bad_request;
    BadRequest::FieldViolation* violation = bad_request.add_field_violations();
    violation->set_field(error.field);
    violation->set_description(error.message);
    google::protobuf::Any* detail = details.add_details();
    detail->set_type_url("type.googleapis.com/google.rpc.BadRequest");
    detail->set_value(bad_request.SerializeAsString());
  }
  return {ToCode(error.code), error.message, details.SerializeAsString()};
}

}  // namespace mane::rpc
