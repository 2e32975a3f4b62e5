#pragma once

#include <concepts>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>

#include "base/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace mane::storage {

/// A borrowed run of bytes, bound as a BLOB without a copy: it must outlive the statement.
struct Blob {
  std::string_view bytes;
};

/// One prepared SQL statement; finalised when it goes. Made by Database::Prepare.
///
/// Threads: as its database, one at a time.
/// Errors:  of Step, those of DatabaseError. A parameter that could not be bound (too big, no
///          memory) is reported by the first Step.
class Statement {
 public:
  explicit Statement(sqlite3_stmt* statement) : statement_(statement) {}

  /// Binds parameter `index`, from 1. Text is copied; an unsigned 64-bit number keeps its bits.
  template <std::integral T>
  void Bind(int index, T value) {
    BindInteger(index, static_cast<int64_t>(value));
  }
  void Bind(int index, double value);
  void Bind(int index, std::string_view text);
  void Bind(int index, Blob blob);

  /// Moves to the next row; false when there is none.
  Result<bool> Step();
  /// Steps to the end, for a statement that returns no rows.
  Result<void> Run();

  /// Columns of the present row, from 0.
  [[nodiscard]] int64_t Integer(int column) const;
  [[nodiscard]] double Real(int column) const;
  /// Text or bytes; empty for NULL.
  [[nodiscard]] std::string Bytes(int column) const;

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const;
  };

  void BindInteger(int index, int64_t value);
  void Note(int code) {
    if (bind_code_ == 0) bind_code_ = code;
  }

  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
  int bind_code_ = 0;  // First failure of a Bind.
};

/// The Error for SQLite result `code` on `database` (null if it could not even be allocated).
/// Disk, lock, corruption: kUnavailable. Full disk, no memory, too big: kResourceExhausted. The
/// rest is this program's fault: kInternal. Tells no path, for clients read it.
[[nodiscard]] Error DatabaseError(sqlite3* database, int code);

}  // namespace mane::storage
