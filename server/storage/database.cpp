#include "storage/database.h"

#include <sqlite3.h>

#include "storage/schema.h"

namespace mane::storage {

namespace {

constexpr int kBusyTimeoutMs = 10'000;

// Reads the only value of a PRAGMA or SELECT as text.
Result<std::string> ReadText(Database& database, std::string_view sql) {
  auto statement = database.Prepare(sql);
  if (!statement) return statement.error();
  auto row = statement->Step();
  if (!row) return row.error();
  return *row ? statement->Bytes(0) : std::string();
}

}  // namespace

void Database::Closer::operator()(sqlite3* connection) const { sqlite3_close_v2(connection); }

Result<Database> Database::Open(const std::filesystem::path& path) {
  sqlite3* connection = nullptr;
  const int flags =
      SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  const int code = sqlite3_open_v2(path.c_str(), &connection, flags, nullptr);
  Database database(connection);  // SQLite hands out a connection on failure too.
  Result<void> ready = code == SQLITE_OK ? database.Configure() : DatabaseError(connection, code);
  if (ready) ready = Migrate(database);
  if (!ready) {
    Error error = ready.error();
    error.message = fmt::format("cannot use {}: {}", path.string(), error.message);
    return error;
  }
  return database;
}

Result<void> Database::Configure() {
  sqlite3_busy_timeout(connection_.get(), kBusyTimeoutMs);
  if (sqlite3_db_readonly(connection_.get(), "main") == 1) {
    return Error{ErrorCode::kUnavailable, "the file is read-only for this user", ""};
  }
  // Before the first write, so that a file of another program stays as it is.
  if (auto ours = CheckOwner(*this); !ours) return ours;
  auto mode = ReadText(*this, "PRAGMA journal_mode=WAL");
  if (!mode) return mode.error();
  if (*mode != "wal") {
    return Error{
        ErrorCode::kUnavailable,
        fmt::format("its file system supports no write-ahead log (journal mode {})", *mode), ""};
  }
  // The log is cut back to 64 MiB after a larger write.
  return RunScript(
      "PRAGMA synchronous=FULL;"
      "PRAGMA foreign_keys=ON;"
      "PRAGMA journal_size_limit=67108864;");
}

Result<Statement> Database::Compile(std::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int code = sqlite3_prepare_v2(connection_.get(), sql.data(), static_cast<int>(sql.size()),
                                      &statement, nullptr);
  if (code != SQLITE_OK) return DatabaseError(connection_.get(), code);
  return Statement(statement);
}

Result<void> Database::RunScript(const char* sql) {
  const int code = sqlite3_exec(connection_.get(), sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) return DatabaseError(connection_.get(), code);
  return {};
}

int64_t Database::ChangedRows() const { return sqlite3_changes64(connection_.get()); }

int64_t Database::LastRowId() const { return sqlite3_last_insert_rowid(connection_.get()); }

bool Database::InTransaction() const { return sqlite3_get_autocommit(connection_.get()) == 0; }

Result<Transaction> Transaction::Begin(Database& database) {
  MANE_CHECK(!database.InTransaction());
  if (auto begun = database.RunScript("BEGIN IMMEDIATE"); !begun) return begun.error();
  return Transaction(database);
}

Transaction::~Transaction() {
  // SQLite has already rolled back after some failures. A rollback that fails leaves nothing to do:
  // the next Begin reports what is wrong.
  if (database_ && database_->InTransaction()) {
    [[maybe_unused]] const auto rolled_back = database_->RunScript("ROLLBACK");
  }
}

Result<void> Transaction::Commit() { return database_->RunScript("COMMIT"); }

}  // namespace mane::storage
