#include "status.h"

#include <google/protobuf/unknown_field_set.h>

#include <optional>
#include <string>

namespace mane::inline client {
namespace {

using google::protobuf::UnknownField;
using google::protobuf::UnknownFieldSet;

// Field numbers of google.rpc.Status, google.protobuf.Any and google.rpc.BadRequest.
constexpr int kStatusDetails = 3;
constexpr int kAnyTypeUrl = 1;
constexpr int kAnyValue = 2;
constexpr int kBadRequestViolations = 1;
constexpr int kViolationField = 1;
constexpr int kViolationDescription = 2;

// The first string, bytes or message field with this number, if the message has one.
std::optional<std::string> Find(const std::string& message, int number) {
  UnknownFieldSet fields;
  if (!fields.ParseFromString(message)) return std::nullopt;
  for (int i = 0; i < fields.field_count(); ++i) {
    const UnknownField& field = fields.field(i);
    if (field.number() == number && field.type() == UnknownField::TYPE_LENGTH_DELIMITED) {
      return field.length_delimited();
    }
  }
  return std::nullopt;
}

// The serialized BadRequest among a status's details.
std::optional<std::string> FindBadRequest(const std::string& status) {
  UnknownFieldSet fields;
  if (!fields.ParseFromString(status)) return std::nullopt;
  for (int i = 0; i < fields.field_count(); ++i) {
    const UnknownField& field = fields.field(i);
    if (field.number() != kStatusDetails || field.type() != UnknownField::TYPE_LENGTH_DELIMITED) {
      continue;
    }
    const std::string& any = field.length_delimited();
    if (Find(any, kAnyTypeUrl).value_or("").ends_with("/google.rpc.BadRequest")) {
      return Find(any, kAnyValue);
    }
  }
  return std::nullopt;
}

}  // namespace

Error ToError(const grpc::Status& status) {
  Error error{static_cast<ErrorCode>(status.error_code()), status.error_message(), ""};
  const auto bad_request = FindBadRequest(status.error_details());
  if (!bad_request) return error;
  const auto violation = Find(*bad_request, kBadRequestViolations);
  if (!violation) return error;
  error.field = Find(*violation, kViolationField).value_or("");
  error.message = Find(*violation, kViolationDescription).value_or(error.message);
  return error;
}

}  // namespace mane::inline client
