// Properties of the database file:
//   settings     write-ahead log, full sync, foreign keys on every connection
//   schema       made once, kept by a second opening; a newer one is refused and left alone
//   refusal      damaged, foreign, read-only or missing files give an error that names the file
//   transaction  all or nothing; statements hand back what was bound

#include "storage/database.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdint>
#include <fstream>
#include <limits>

#include "storage/schema.h"
#include "storage/test_folder.h"

namespace mane::storage {
namespace {

std::string ReadValue(Database& database, std::string_view sql) {
  auto statement = database.Prepare(sql);
  if (!statement) return statement.error().message;
  auto row = statement->Step();
  if (!row) return row.error().message;
  return *row ? statement->Bytes(0) : "no row";
}

std::string ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void WriteFile(const std::filesystem::path& path, std::string_view bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

void ExpectRefused(const std::filesystem::path& path, ErrorCode code, std::string_view reason) {
  const auto database = Database::Open(path);
  ASSERT_FALSE(database) << path;
  EXPECT_EQ(database.error().code, code) << database.error().message;
  EXPECT_NE(database.error().message.find(path.string()), std::string::npos)
      << database.error().message;
  EXPECT_NE(database.error().message.find(reason), std::string::npos) << database.error().message;
}

TEST(DatabaseTest, EveryConnectionIsDurableAndChecksForeignKeys) {
  TestFolder folder;
  for (int i = 0; i < 2; ++i) {
    auto database = Database::Open(folder.DatabasePath());
    MANE_ASSERT_OK(database);
    EXPECT_EQ(ReadValue(*database, "PRAGMA journal_mode"), "wal");
    EXPECT_EQ(ReadValue(*database, "PRAGMA synchronous"), "2");  // FULL.
    EXPECT_EQ(ReadValue(*database, "PRAGMA foreign_keys"), "1");
    const auto orphan =
        database->Run("INSERT INTO groom_contents (groom_id, groom, rest) VALUES ('x', '', '')");
    EXPECT_FALSE(orphan);
  }
}

TEST(DatabaseTest, EachMigrationIsRecordedOnce) {
  TestFolder folder;
  for (int i = 0; i < 3; ++i) {
    auto database = Database::Open(folder.DatabasePath());
    MANE_ASSERT_OK(database);
    EXPECT_EQ(ReadValue(*database, "SELECT count(*) FROM schema_migrations"),
              std::to_string(SchemaVersion()));
    EXPECT_EQ(ReadValue(*database, "SELECT max(version) FROM schema_migrations"),
              std::to_string(SchemaVersion()));
  }
}

TEST(DatabaseTest, NewerSchemaIsRefusedAndLeftAlone) {
  TestFolder folder;
  const int newer = SchemaVersion() + 1;
  {
    auto database = Database::Open(folder.DatabasePath());
    MANE_ASSERT_OK(database);
    MANE_ASSERT_OK(database->Run(
        "INSERT INTO schema_migrations (version, applied_time_ns) VALUES (?, 0)", newer));
  }
  const std::string before = ReadFile(folder.DatabasePath());
  ExpectRefused(folder.DatabasePath(), ErrorCode::kFailedPrecondition,
                fmt::format("schema {}", newer));
  EXPECT_EQ(ReadFile(folder.DatabasePath()), before);
}

TEST(DatabaseTest, FileOfAnotherProgramIsRefusedAndLeftAlone) {
  TestFolder folder;
  {
    auto database = Database::Open(folder.DatabasePath());
    MANE_ASSERT_OK(database);
    MANE_ASSERT_OK(database->RunScript("PRAGMA application_id=12345"));
  }
  const std::string before = ReadFile(folder.DatabasePath());
  ExpectRefused(folder.DatabasePath(), ErrorCode::kFailedPrecondition, "another program");
  EXPECT_EQ(ReadFile(folder.DatabasePath()), before);
}

TEST(DatabaseTest, FileThatIsNoDatabaseIsRefusedAndLeftAlone) {
  TestFolder folder;
  const std::string text(8192, 'x');
  WriteFile(folder.DatabasePath(), text);
  ExpectRefused(folder.DatabasePath(), ErrorCode::kUnavailable, "not a database");
  EXPECT_EQ(ReadFile(folder.DatabasePath()), text);
}

TEST(DatabaseTest, DamagedSchemaIsRefused) {
  TestFolder folder;
  MANE_ASSERT_OK(Database::Open(folder.DatabasePath()));
  std::string bytes = ReadFile(folder.DatabasePath());
  ASSERT_GT(bytes.size(), 4096u);
  bytes.replace(100, 3996, 3996, '\x5a');  // The first page but for the file's header.
  WriteFile(folder.DatabasePath(), bytes);
  ExpectRefused(folder.DatabasePath(), ErrorCode::kUnavailable, "malformed");
}

TEST(DatabaseTest, PathThatCannotBeOpenedIsRefused) {
  TestFolder folder;
  ExpectRefused(folder.path(), ErrorCode::kUnavailable, "unable to open");
  ExpectRefused(folder.path() / "missing" / "mane.db", ErrorCode::kUnavailable, "unable to open");
}

// As an ordinary user, because root may write everything.
TEST(DatabaseTest, ReadOnlyFileIsRefused) {
  TestFolder folder;
  MANE_ASSERT_OK(Database::Open(folder.DatabasePath()));
  using std::filesystem::perms;
  const perms read = perms::owner_read | perms::group_read | perms::others_read;
  const perms enter = perms::owner_exec | perms::group_exec | perms::others_exec;
  std::filesystem::permissions(folder.DatabasePath(), read);
  std::filesystem::permissions(folder.path(), read | enter);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (getuid() == 0 && setuid(kNobody) != 0) _exit(2);
    ExpectRefused(folder.DatabasePath(), ErrorCode::kUnavailable, "read-only");
    _exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 0);
  std::filesystem::permissions(folder.path(), perms::owner_all);
}

TEST(DatabaseTest, TransactionThatIsNotCommittedLeavesNothing) {
  TestFolder folder;
  auto database = Database::Open(folder.DatabasePath());
  MANE_ASSERT_OK(database);
  MANE_ASSERT_OK(database->RunScript("CREATE TABLE t (x)"));
  {
    auto transaction = Transaction::Begin(*database);
    MANE_ASSERT_OK(transaction);
    MANE_ASSERT_OK(database->Run("INSERT INTO t VALUES (?)", 1));
  }
  EXPECT_EQ(ReadValue(*database, "SELECT count(*) FROM t"), "0");
  {
    auto transaction = Transaction::Begin(*database);
    MANE_ASSERT_OK(transaction);
    MANE_ASSERT_OK(database->Run("INSERT INTO t VALUES (?)", 1));
    MANE_ASSERT_OK(transaction->Commit());
  }
  EXPECT_EQ(ReadValue(*database, "SELECT count(*) FROM t"), "1");
}

TEST(DatabaseTest, ValuesComeBackAsBound) {
  TestFolder folder;
  auto database = Database::Open(folder.DatabasePath());
  MANE_ASSERT_OK(database);
  const std::string bytes("\0a\xff", 3);
  auto statement = database->Prepare(
      "SELECT ?, ?, ?, ?, ?, ? = '', ? = x''", std::numeric_limits<uint64_t>::max() - 6, 0.1,
      std::string_view("häir"), Blob{bytes}, true, std::string_view(), Blob{});
  MANE_ASSERT_OK(statement);
  const auto row = statement->Step();
  MANE_ASSERT_OK(row);
  ASSERT_TRUE(*row);
  EXPECT_EQ(static_cast<uint64_t>(statement->Integer(0)), std::numeric_limits<uint64_t>::max() - 6);
  EXPECT_EQ(statement->Real(1), 0.1);
  EXPECT_EQ(statement->Bytes(2), "häir");
  EXPECT_EQ(statement->Bytes(3), bytes);
  EXPECT_EQ(statement->Integer(4), 1);
  EXPECT_EQ(statement->Integer(5), 1);
  EXPECT_EQ(statement->Integer(6), 1);
}

TEST(DatabaseTest, WrongSqlOrParameterIsAnInternalFault) {
  TestFolder folder;
  auto database = Database::Open(folder.DatabasePath());
  MANE_ASSERT_OK(database);
  const auto unknown = database->Run("SELECT * FROM nowhere");
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kInternal);
  const auto too_many = database->Run("SELECT ?", 1, 2);
  ASSERT_FALSE(too_many);
  EXPECT_EQ(too_many.error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace mane::storage
