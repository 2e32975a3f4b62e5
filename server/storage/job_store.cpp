#include "storage/job_store.h"

#include <charconv>
#include <chrono>
#include <limits>
#include <utility>

#include "base/text.h"

namespace mane::storage {

namespace {

// A job's place in the order of insertion, by which its spec and result hang on it.
struct Row {
  int64_t sequence = 0;
  JobRecord job;
};

// Its columns in the order in which ReadRow reads them.
constexpr std::string_view kSelect =
    "SELECT sequence, id, request_id, kind, description, state, cancel_requested, progress, error, "
    "create_time_ns, start_time_ns, end_time_ns, result_chunks, result_bytes FROM jobs";

Row ReadRow(const Statement& row) {
  JobRecord job;
  job.id = row.Bytes(1);
  job.request_id = row.Bytes(2);
  job.kind = row.Bytes(3);
  job.description = row.Bytes(4);
  job.state = static_cast<JobState>(row.Integer(5));
  job.cancel_requested = row.Integer(6) != 0;
  job.progress = row.Real(7);
  job.error = row.Bytes(8);
  job.create_time_ns = row.Integer(9);
  job.start_time_ns = row.Integer(10);
  job.end_time_ns = row.Integer(11);
  job.result_chunks = row.Integer(12);
  job.result_bytes = row.Integer(13);
  return {row.Integer(0), std::move(job)};
}

int64_t NowNs() {
  return std::chrono::nanoseconds(std::chrono::system_clock::now().time_since_epoch()).count();
}

// The first job that fulfils `condition`.
template <typename... Parameters>
Result<std::optional<Row>> FindFirst(Database& database, std::string_view condition,
                                     const Parameters&... parameters) {
  auto statement = database.Prepare(fmt::format("{} {}", kSelect, condition), parameters...);
  if (!statement) return statement.error();
  auto row = statement->Step();
  if (!row) return row.error();
  if (!*row) return std::optional<Row>();
  return std::optional(ReadRow(*statement));
}

Result<Row> GetRow(Database& database, std::string_view id) {
  auto row = FindFirst(database, "WHERE id = ?", id);
  if (!row) return row.error();
  if (*row) return std::move(**row);
  return Error{ErrorCode::kNotFound, fmt::format("there is no job `jobs/{}`", id), ""};
}

// As GetRow, for what only a running job allows.
Result<Row> GetRunning(Database& database, std::string_view id) {
  auto row = GetRow(database, id);
  if (row && row->job.state != JobState::kRunning) {
    return Error{ErrorCode::kFailedPrecondition, fmt::format("`jobs/{}` is not running", id), ""};
  }
  return row;
}

Result<void> CheckRoom(Database& database, int64_t max_queued) {
  auto statement = database.Prepare("SELECT count(*) FROM jobs WHERE state = ?",
                                    static_cast<int>(JobState::kQueued));
  if (!statement) return statement.error();
  auto row = statement->Step();
  if (!row) return row.error();
  if (statement->Integer(0) < max_queued) return {};
  return Error{ErrorCode::kResourceExhausted,
               fmt::format("{} jobs are queued; the server takes at most {}", statement->Integer(0),
                           max_queued),
               ""};
}

Result<void> InsertJob(Database& database, const NewJob& job) {
  auto inserted = database.Run(
      "INSERT INTO jobs (id, request_id, kind, description, state, create_time_ns) "
      "VALUES (?, nullif(?, ''), ?, ?, ?, ?)",
      job.id, job.request_id, job.kind, job.description, static_cast<int>(JobState::kQueued),
      NowNs());
  if (!inserted) return inserted;
  return database.Run("INSERT INTO job_specs (sequence, spec) VALUES (?, ?)", database.LastRowId(),
                      Blob{job.spec});
}

Result<void> DropResult(Database& database, int64_t sequence) {
  auto deleted = database.Run("DELETE FROM job_results WHERE sequence = ?", sequence);
  if (!deleted) return deleted;
  return database.Run("UPDATE jobs SET result_chunks = 0, result_bytes = 0 WHERE sequence = ?",
                      sequence);
}

Result<void> EndJob(Database& database, int64_t sequence, JobState state, std::string_view error) {
  if (state != JobState::kSucceeded) {
    if (auto dropped = DropResult(database, sequence); !dropped) return dropped;
  }
  return database.Run(
      "UPDATE jobs SET state = ?, error = ?, end_time_ns = ?, "
      "progress = iif(?, 1, progress) WHERE sequence = ?",
      static_cast<int>(state), error, NowNs(), state == JobState::kSucceeded, sequence);
}

Result<void> RequeueJob(Database& database, const Row& row) {
  if (row.job.cancel_requested) return EndJob(database, row.sequence, JobState::kCancelled, "");
  if (auto dropped = DropResult(database, row.sequence); !dropped) return dropped;
  return database.Run(
      "UPDATE jobs SET state = ?, progress = 0, start_time_ns = 0 WHERE sequence = ?",
      static_cast<int>(JobState::kQueued), row.sequence);
}

// The sequence number behind which a page begins; everything is before the largest number.
Result<int64_t> ParsePageToken(std::string_view token) {
  if (token.empty()) return std::numeric_limits<int64_t>::max();
  int64_t sequence = 0;
  const char* end = token.data() + token.size();
  const auto parsed = std::from_chars(token.data(), end, sequence);
  if (parsed.ec == std::errc() && parsed.ptr == end && sequence > 0) return sequence;
  return InvalidArgument(
      "page_token", fmt::format("page_token is `{}`, which no answer gave", base::Shown(token)));
}

}  // namespace

Result<std::unique_ptr<JobStore>> JobStore::Open(const std::filesystem::path& path) {
  auto database = Database::Open(path);
  if (!database) return database.error();
  return std::unique_ptr<JobStore>(new JobStore(std::move(*database)));
}

Result<JobRecord> JobStore::Insert(const NewJob& job, int64_t max_queued) {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();

  if (!job.request_id.empty()) {
    auto earlier = FindFirst(database_, "WHERE request_id = ?", job.request_id);
    if (!earlier) return earlier.error();
    if (*earlier) return std::move((*earlier)->job);
  }
  auto namesake = FindFirst(database_, "WHERE id = ?", job.id);
  if (!namesake) return namesake.error();
  if (*namesake) {
    return Error{ErrorCode::kAlreadyExists, fmt::format("`jobs/{}` already exists", job.id), ""};
  }
  if (auto room = CheckRoom(database_, max_queued); !room) return room.error();

  if (auto inserted = InsertJob(database_, job); !inserted) return inserted.error();
  auto row = GetRow(database_, job.id);
  if (!row) return row.error();
  if (auto committed = transaction->Commit(); !committed) return committed.error();
  return std::move(row->job);
}

Result<JobRecord> JobStore::Get(std::string_view id) {
  std::lock_guard lock(mutex_);
  auto row = GetRow(database_, id);
  if (!row) return row.error();
  return std::move(row->job);
}

Result<Page<JobRecord>> JobStore::List(int page_size, std::string_view page_token) {
  if (auto checked = CheckPageSize(page_size); !checked) return checked.error();
  auto before = ParsePageToken(page_token);
  if (!before) return before.error();
  std::lock_guard lock(mutex_);
  // One more than the page tells whether there is a next one.
  auto statement = database_.Prepare(
      fmt::format("{} WHERE sequence < ? ORDER BY sequence DESC LIMIT ?", kSelect), *before,
      page_size + 1);
  if (!statement) return statement.error();
  Page<JobRecord> page;
  int64_t last_sequence = 0;
  while (true) {
    auto next = statement->Step();
    if (!next) return next.error();
    if (!*next) return page;
    if (static_cast<int>(page.records.size()) == page_size) {
      page.next_page_token = fmt::to_string(last_sequence);
      return page;
    }
    Row row = ReadRow(*statement);
    last_sequence = row.sequence;
    page.records.push_back(std::move(row.job));
  }
}

Result<std::optional<ClaimedJob>> JobStore::ClaimNext() {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  auto oldest = FindFirst(database_, "WHERE state = ? ORDER BY sequence LIMIT 1",
                          static_cast<int>(JobState::kQueued));
  if (!oldest) return oldest.error();
  if (!*oldest) return std::optional<ClaimedJob>();

  Row& row = **oldest;
  row.job.state = JobState::kRunning;
  row.job.start_time_ns = NowNs();
  auto claimed =
      database_.Run("UPDATE jobs SET state = ?, start_time_ns = ? WHERE sequence = ?",
                    static_cast<int>(row.job.state), row.job.start_time_ns, row.sequence);
  if (!claimed) return claimed.error();
  auto spec = database_.Prepare("SELECT spec FROM job_specs WHERE sequence = ?", row.sequence);
  if (!spec) return spec.error();
  auto found = spec->Step();
  if (!found) return found.error();
  MANE_CHECK(*found);
  ClaimedJob job{std::move(row.job), spec->Bytes(0)};
  if (auto committed = transaction->Commit(); !committed) return committed.error();
  return std::optional(std::move(job));
}

Result<void> JobStore::SetProgress(std::string_view id, double progress) {
  std::lock_guard lock(mutex_);
  return database_.Run("UPDATE jobs SET progress = ? WHERE id = ? AND state = ?", progress, id,
                       static_cast<int>(JobState::kRunning));
}

Result<void> JobStore::AppendResult(std::string_view id, int64_t chunk, std::string_view bytes) {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  auto row = GetRunning(database_, id);
  if (!row) return row.error();
  if (chunk != row->job.result_chunks) {
    return Error{ErrorCode::kFailedPrecondition,
                 fmt::format("chunk {} of `jobs/{}` cannot be added; the next one is {}", chunk, id,
                             row->job.result_chunks),
                 ""};
  }
  auto added = database_.Run("INSERT INTO job_results (sequence, chunk, bytes) VALUES (?, ?, ?)",
                             row->sequence, chunk, Blob{bytes});
  if (!added) return added;
  auto counted = database_.Run(
      "UPDATE jobs SET result_chunks = result_chunks + 1, result_bytes = result_bytes + ? "
      "WHERE sequence = ?",
      bytes.size(), row->sequence);
  if (!counted) return counted;
  return transaction->Commit();
}

Result<std::string> JobStore::ReadResult(std::string_view id, int64_t chunk) {
  std::lock_guard lock(mutex_);
  auto row = GetRow(database_, id);
  if (!row) return row.error();
  auto statement = database_.Prepare(
      "SELECT bytes FROM job_results WHERE sequence = ? AND chunk = ?", row->sequence, chunk);
  if (!statement) return statement.error();
  auto found = statement->Step();
  if (!found) return found.error();
  if (*found) return statement->Bytes(0);
  return Error{ErrorCode::kNotFound,
               fmt::format("`jobs/{}` has no result chunk {}; it has {} of them", id, chunk,
                           row->job.result_chunks),
               ""};
}

Result<void> JobStore::Finish(std::string_view id, JobState state, std::string_view error) {
  MANE_CHECK(HasEnded(state));
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  auto row = GetRunning(database_, id);
  if (!row) return row.error();
  if (auto ended = EndJob(database_, row->sequence, state, error); !ended) return ended;
  return transaction->Commit();
}

Result<JobRecord> JobStore::RequestCancel(std::string_view id) {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  auto row = GetRow(database_, id);
  if (!row) return row.error();
  if (HasEnded(row->job.state)) return std::move(row->job);

  Result<void> changed =
      row->job.state == JobState::kQueued
          ? EndJob(database_, row->sequence, JobState::kCancelled, "")
          : database_.Run("UPDATE jobs SET cancel_requested = 1 WHERE sequence = ?", row->sequence);
  if (!changed) return changed.error();
  row = GetRow(database_, id);
  if (!row) return row.error();
  if (auto committed = transaction->Commit(); !committed) return committed.error();
  return std::move(row->job);
}

Result<void> JobStore::Requeue(std::string_view id) {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  auto row = GetRunning(database_, id);
  if (!row) return row.error();
  if (auto requeued = RequeueJob(database_, *row); !requeued) return requeued;
  return transaction->Commit();
}

Result<void> JobStore::RequeueInterrupted() {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  while (true) {
    auto row =
        FindFirst(database_, "WHERE state = ? LIMIT 1", static_cast<int>(JobState::kRunning));
    if (!row) return row.error();
    if (!*row) return transaction->Commit();
    if (auto requeued = RequeueJob(database_, **row); !requeued) return requeued;
  }
}

Result<void> JobStore::Delete(std::string_view id) {
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();
  auto row = GetRow(database_, id);
  if (!row) return row.error();
  if (!HasEnded(row->job.state)) {
    return Error{ErrorCode::kFailedPrecondition,
                 fmt::format("`jobs/{}` is {}; only an ended job can be deleted", id,
                             row->job.state == JobState::kQueued ? "queued" : "running"),
                 ""};
  }
  auto deleted = database_.Run("DELETE FROM jobs WHERE sequence = ?", row->sequence);
  if (!deleted) return deleted;
  return transaction->Commit();
}

Result<void> JobStore::DeleteOldest(int64_t keep) {
  std::lock_guard lock(mutex_);
  return database_.Run(
      "DELETE FROM jobs WHERE sequence IN (SELECT sequence FROM jobs WHERE state >= ? "
      "ORDER BY end_time_ns DESC, sequence DESC LIMIT -1 OFFSET ?)",
      static_cast<int>(JobState::kSucceeded), keep);
}

}  // namespace mane::storage
