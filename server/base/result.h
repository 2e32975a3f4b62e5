#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <utility>
#include <variant>

#include "base/check.h"

namespace mane {

/// Whose fault an error is and what the caller can do about it; each maps to one gRPC status.
enum class ErrorCode {
  kInvalidArgument,     ///< The input is wrong whatever the state; `field` names it.
  kNotFound,            ///< The named thing does not exist.
  kAlreadyExists,       ///< The name is taken.
  kFailedPrecondition,  ///< Right input at the wrong time.
  kResourceExhausted,   ///< A limit is reached; later or elsewhere it may work.
  kCancelled,           ///< Stopped on request.
  kUnavailable,         ///< The environment failed (disk, peer); worth a retry.
  kInternal,            ///< A fault of this program.
};

/// What went wrong, as data. `message` is a sentence with the value sent and the range allowed.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  std::string field;  ///< Path of the offending input, `guides[3].length_m`; empty if none.
};

/// INVALID_ARGUMENT for `field`.
[[nodiscard]] inline Error InvalidArgument(std::string field, std::string message) {
  return {ErrorCode::kInvalidArgument, std::move(message), std::move(field)};
}

/// A value or an Error, with the spelling of std::expected (which C++20 lacks).
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : content_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : content_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool has_value() const { return content_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  /// The value; it must be there.
  T& operator*() & { return Checked(); }
  const T& operator*() const& { return const_cast<Result*>(this)->Checked(); }
  T&& operator*() && { return std::move(Checked()); }
  T* operator->() { return &Checked(); }
  const T* operator->() const { return &const_cast<Result*>(this)->Checked(); }

  /// The error; there must be one.
  [[nodiscard]] const Error& error() const {
    MANE_CHECK(!has_value());
    return std::get<1>(content_);
  }

 private:
  T& Checked() {
    MANE_CHECK(has_value());
    return std::get<0>(content_);
  }

  std::variant<T, Error> content_;
};

/// Success or an Error.
template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool has_value() const { return !error_; }
  explicit operator bool() const { return has_value(); }
  [[nodiscard]] const Error& error() const {
    MANE_CHECK(error_.has_value());
    return *error_;
  }

 private:
  std::optional<Error> error_;
};

}  // namespace mane
