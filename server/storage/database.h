#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

#include "base/result.h"
#include "storage/statement.h"

namespace mane::storage {

/// One connection to Mane's SQLite file, at the present schema.
///
/// What is committed survives the death of the process and of the machine: write-ahead log, synced
/// at every commit (journal_mode=WAL, synchronous=FULL). Foreign keys are enforced. Several
/// connections may share the file; each waits up to 10 s for another one's write to end. Room that
/// deleted rows leave is used again, but the file never shrinks.
///
/// Threads: a connection serves one thread at a time. Each store has one of its own, behind a
///          mutex of its own.
class Database {
 public:
  /// Opens `path`, or creates it, and brings an older schema up to date.
  ///
  /// kUnavailable when the file cannot be opened or written or is damaged; kFailedPrecondition when
  /// it belongs to another program or a newer version of Mane made it. Damage is looked for in the
  /// header and the schema only; that of a record shows when the record is read.
  static Result<Database> Open(const std::filesystem::path& path);

  /// Prepares `sql` and binds its parameters in order (see Statement::Bind).
  template <typename... Parameters>
  Result<Statement> Prepare(std::string_view sql, const Parameters&... parameters) {
    auto statement = Compile(sql);
    if (statement) {
      int index = 0;
      (statement->Bind(++index, parameters), ...);
    }
    return statement;
  }

  /// Runs one statement to its end.
  template <typename... Parameters>
  Result<void> Run(std::string_view sql, const Parameters&... parameters) {
    auto statement = Prepare(sql, parameters...);
    if (!statement) return statement.error();
    return statement->Run();
  }

  /// Runs statements separated by semicolons, without parameters or rows.
  Result<void> RunScript(const char* sql);

  /// Rows that the last INSERT, UPDATE or DELETE touched.
  [[nodiscard]] int64_t ChangedRows() const;
  /// Row id of the last INSERT.
  [[nodiscard]] int64_t LastRowId() const;
  [[nodiscard]] bool InTransaction() const;

 private:
  struct Closer {
    void operator()(sqlite3* connection) const;
  };

  explicit Database(sqlite3* connection) : connection_(connection) {}
  Result<void> Configure();
  Result<Statement> Compile(std::string_view sql);

  std::unique_ptr<sqlite3, Closer> connection_;
};

/// A write transaction; rolled back unless committed. The database must outlive it.
class Transaction {
 public:
  /// Takes the file's write lock, so that nothing read inside changes before Commit.
  static Result<Transaction> Begin(Database& database);

  Transaction(Transaction&& other) noexcept : database_(std::exchange(other.database_, nullptr)) {}
  Transaction& operator=(Transaction&&) = delete;
  ~Transaction();

  /// On disk when it returns success. On an error nothing of the transaction remains.
  Result<void> Commit();

 private:
  explicit Transaction(Database& database) : database_(&database) {}

  Database* database_;  // Null when moved from.
};

}  // namespace mane::storage
