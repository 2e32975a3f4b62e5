#include "storage/schema.h"

#include <array>
#include <chrono>

#include "storage/database.h"

namespace mane::storage {

namespace {

// Marks the file as Mane's ("MANE"; see sqlite.org, PRAGMA application_id).
constexpr int64_t kApplicationId = 0x4d414e45;

// Migration k takes schema k to k + 1. A released one never changes. Numbers of `jobs.state` are
// those of JobState. What is large or never updated has rows of its own, because an update rewrites
// its whole row.
constexpr std::array kMigrations = {
    R"sql(
      CREATE TABLE grooms (
        id TEXT PRIMARY KEY NOT NULL,
        request_id TEXT UNIQUE,
        display_name TEXT NOT NULL,
        hair_type INTEGER NOT NULL,
        seed INTEGER NOT NULL,
        guide_count INTEGER NOT NULL,
        element_count INTEGER NOT NULL,
        longest_guide_m REAL NOT NULL,
        has_scalp INTEGER NOT NULL,
        etag TEXT NOT NULL,
        create_time_ns INTEGER NOT NULL
      );
      CREATE TABLE groom_contents (
        groom_id TEXT PRIMARY KEY NOT NULL REFERENCES grooms (id) ON DELETE CASCADE,
        groom BLOB NOT NULL,
        rest BLOB NOT NULL
      );
      CREATE TABLE jobs (
        sequence INTEGER PRIMARY KEY AUTOINCREMENT,
        id TEXT UNIQUE NOT NULL,
        request_id TEXT UNIQUE,
        kind TEXT NOT NULL,
        description TEXT NOT NULL,
        state INTEGER NOT NULL,
        cancel_requested INTEGER NOT NULL DEFAULT 0,
        progress REAL NOT NULL DEFAULT 0,
        error TEXT NOT NULL DEFAULT '',
        create_time_ns INTEGER NOT NULL,
        start_time_ns INTEGER NOT NULL DEFAULT 0,
        end_time_ns INTEGER NOT NULL DEFAULT 0,
        result_chunks INTEGER NOT NULL DEFAULT 0,
        result_bytes INTEGER NOT NULL DEFAULT 0
      );
      CREATE INDEX jobs_by_state ON jobs (state, sequence);
      CREATE TABLE job_specs (
        sequence INTEGER PRIMARY KEY REFERENCES jobs (sequence) ON DELETE CASCADE,
        spec BLOB NOT NULL
      );
      CREATE TABLE job_results (
        sequence INTEGER NOT NULL REFERENCES jobs (sequence) ON DELETE CASCADE,
        chunk INTEGER NOT NULL,
        bytes BLOB NOT NULL,
        PRIMARY KEY (sequence, chunk)
      );
    )sql",
    R"sql(
      ALTER TABLE grooms ADD COLUMN import_summary BLOB NOT NULL DEFAULT x'';
    )sql",
    R"sql(
      ALTER TABLE grooms ADD COLUMN contact BLOB NOT NULL DEFAULT x'';
    )sql",
    R"sql(
      ALTER TABLE grooms ADD COLUMN hair_count INTEGER NOT NULL DEFAULT 0;
      ALTER TABLE grooms ADD COLUMN hair_point_count INTEGER NOT NULL DEFAULT 0;
      ALTER TABLE grooms ADD COLUMN hair_offset_unit_m REAL NOT NULL DEFAULT 0;
    )sql",
};

Result<int64_t> ReadInteger(Database& database, std::string_view sql) {
  auto statement = database.Prepare(sql);
  if (!statement) return statement.error();
  auto row = statement->Step();
  if (!row) return row.error();
  MANE_CHECK(*row);
  return statement->Integer(0);
}

Result<void> Apply(Database& database, int migration) {
  if (auto done = database.RunScript(kMigrations[migration]); !done) return done;
  const int64_t now_ns =
      std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
  return database.Run("INSERT INTO schema_migrations (version, applied_time_ns) VALUES (?, ?)",
                      migration + 1, now_ns);
}

}  // namespace

int SchemaVersion() { return static_cast<int>(kMigrations.size()); }

Result<void> CheckOwner(Database& database) {
  auto application = ReadInteger(database, "PRAGMA application_id");
  if (!application) return application.error();
  auto tables = ReadInteger(database, "SELECT count(*) FROM sqlite_schema");
  if (!tables) return tables.error();
  if (*application == kApplicationId || (*application == 0 && *tables == 0)) return {};
  return Error{ErrorCode::kFailedPrecondition, "it is the SQLite database of another program", ""};
}

Result<void> Migrate(Database& database) {
  auto transaction = Transaction::Begin(database);
  if (!transaction) return transaction.error();
  auto prepared = database.RunScript(
      "CREATE TABLE IF NOT EXISTS schema_migrations ("
      "  version INTEGER PRIMARY KEY, applied_time_ns INTEGER NOT NULL)");
  if (!prepared) return prepared;

  auto version = ReadInteger(database, "SELECT coalesce(max(version), 0) FROM schema_migrations");
  if (!version) return version.error();
  if (*version > SchemaVersion()) {
    return Error{ErrorCode::kFailedPrecondition,
                 fmt::format("it has schema {}, made by a newer version of Mane; this one reads up "
                             "to schema {}",
                             *version, SchemaVersion()),
                 ""};
  }
  if (*version == SchemaVersion()) return {};
  for (int migration = static_cast<int>(*version); migration < SchemaVersion(); ++migration) {
    if (auto done = Apply(database, migration); !done) return done;
  }
  const auto mark = fmt::format("PRAGMA application_id={}", kApplicationId);
  if (auto marked = database.RunScript(mark.c_str()); !marked) return marked;
  return transaction->Commit();
}

}  // namespace mane::storage
