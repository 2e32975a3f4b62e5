#pragma once

#include <string>
#include <utility>
#include <variant>

namespace mane::inline client {

/// What kind of thing went wrong; names and numbers are gRPC's.
enum class ErrorCode {
  kCancelled = 1,
  kUnknown = 2,
  kInvalidArgument = 3,   ///< The input is wrong; `Error::field` names it.
  kDeadlineExceeded = 4,  ///< No answer in time.
  kNotFound = 5,
  kAlreadyExists = 6,
  kPermissionDenied = 7,
  kResourceExhausted = 8,   ///< A limit of the server; later or elsewhere it may work.
  kFailedPrecondition = 9,  ///< Right call at the wrong time.
  kAborted = 10,
  kOutOfRange = 11,
  kUnimplemented = 12,
  kInternal = 13,     ///< A fault of the server or of this library.
  kUnavailable = 14,  ///< The server cannot be reached; worth a retry.
  kDataLoss = 15,
  kUnauthenticated = 16,  ///< The token is missing or wrong.
};

/// What went wrong, as data.
struct Error {
  ErrorCode code = ErrorCode::kUnknown;
  std::string message;  ///< A sentence with the value that was sent and the range that is allowed.
  std::string field;    ///< Path of the offending input, `guides[3].length_m`; empty if none.
};

/// A value or an Error. Nothing in this library throws; reading the part that is not there does
/// (std::bad_variant_access).
template <typename T>
class [[nodiscard]] Result {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor)
  Result(T value) : content_(std::in_place_index<0>, std::move(value)) {}
  // NOLINTNEXTLINE(google-explicit-constructor)
  Result(Error error) : content_(std::in_place_index<1>, std::move(error)) {}

  bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  T& operator*() & { return std::get<0>(content_); }
  const T& operator*() const& { return std::get<0>(content_); }
  T&& operator*() && { return std::get<0>(std::move(content_)); }
  T* operator->() { return &std::get<0>(content_); }
  const T* operator->() const { return &std::get<0>(content_); }

  const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<T, Error> content_;
};

/// Success or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  const Error& error() const { return std::get<1>(content_); }

 private:
  std::variant<std::monostate, Error> content_;
};

}  // namespace mane::inline client
