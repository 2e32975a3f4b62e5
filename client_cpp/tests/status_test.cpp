// Errors name the field when the status carries google.rpc.BadRequest, and survive without.

#include "status.h"

#include <google/protobuf/unknown_field_set.h>
#include <gtest/gtest.h>

#include <string>

namespace mane {
namespace {

using google::protobuf::UnknownFieldSet;

std::string Serialized(const UnknownFieldSet& fields) {
  std::string bytes;
  fields.SerializeToString(&bytes);
  return bytes;
}

// google.rpc.Status with one detail of the given type that says `field` and `description`.
std::string Details(const std::string& type, const std::string& field,
                    const std::string& description) {
  UnknownFieldSet violation, bad_request, any, status;
  violation.AddLengthDelimited(1, field);
  violation.AddLengthDelimited(2, description);
  bad_request.AddLengthDelimited(1, Serialized(violation));
  any.AddLengthDelimited(1, "type.googleapis.com/" + type);
  any.AddLengthDelimited(2, Serialized(bad_request));
  status.AddVarint(1, 3);
  status.AddLengthDelimited(2, "bad");
  status.AddLengthDelimited(3, Serialized(any));
  return Serialized(status);
}

TEST(Status, NamesTheFieldOfABadRequest) {
  const grpc::Status status(grpc::StatusCode::INVALID_ARGUMENT, "short",
                            Details("google.rpc.BadRequest", "guides[3].length_m", "-1, not > 0"));
  const Error error = ToError(status);
  EXPECT_EQ(error.code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(error.field, "guides[3].length_m");
  EXPECT_EQ(error.message, "-1, not > 0");
}

TEST(Status, KeepsTheMessageWithoutOrWithOtherDetails) {
  for (const std::string& details : {std::string(), std::string("\xff\xff garbage"),
                                     Details("google.rpc.ErrorInfo", "reason", "domain")}) {
    const Error error = ToError(grpc::Status(grpc::StatusCode::NOT_FOUND, "no grooms/x", details));
    EXPECT_EQ(error.code, ErrorCode::kNotFound);
    EXPECT_EQ(error.message, "no grooms/x");
    EXPECT_EQ(error.field, "");
  }
}

}  // namespace
}  // namespace mane
