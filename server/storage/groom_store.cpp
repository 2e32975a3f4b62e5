#include "storage/groom_store.h"

#include <utility>

namespace mane::storage {

namespace {

// Its columns in the order in which ReadRecord reads them.
constexpr std::string_view kSelect =
    "SELECT id, request_id, display_name, hair_type, seed, guide_count, element_count, "
    "longest_guide_m, has_scalp, etag, create_time_ns, import_summary, contact, hair_count, "
    "hair_point_count, hair_offset_unit_m FROM grooms";

GroomRecord ReadRecord(const Statement& row) {
  GroomRecord record;
  record.id = row.Bytes(0);
  record.request_id = row.Bytes(1);
  record.display_name = row.Bytes(2);
  record.hair_type = static_cast<int>(row.Integer(3));
  record.seed = static_cast<uint64_t>(row.Integer(4));
  record.guide_count = static_cast<uint32_t>(row.Integer(5));
  record.element_count = static_cast<uint32_t>(row.Integer(6));
  record.longest_guide_m = row.Real(7);
  record.has_scalp = row.Integer(8) != 0;
  record.etag = row.Bytes(9);
  record.create_time_ns = row.Integer(10);
  record.import_summary = row.Bytes(11);
  record.contact = row.Bytes(12);
  record.hair_count = static_cast<uint32_t>(row.Integer(13));
  record.hair_point_count = static_cast<uint64_t>(row.Integer(14));
  record.hair_offset_unit_m = row.Real(15);
  return record;
}

// The groom whose `column` is `key`.
Result<std::optional<GroomRecord>> Find(Database& database, std::string_view column,
                                        std::string_view key) {
  auto statement = database.Prepare(fmt::format("{} WHERE {} = ?", kSelect, column), key);
  if (!statement) return statement.error();
  auto row = statement->Step();
  if (!row) return row.error();
  if (!*row) return std::optional<GroomRecord>();
  return std::optional(ReadRecord(*statement));
}

Result<std::optional<GroomRecord>> FindById(Database& database, std::string_view id) {
  return Find(database, "id", id);
}

Result<std::optional<GroomRecord>> FindByRequest(Database& database, std::string_view request_id) {
  if (request_id.empty()) return std::optional<GroomRecord>();
  return Find(database, "request_id", request_id);
}

Result<void> Insert(Database& database, const GroomRecord& record, const GroomContent& content) {
  auto inserted = database.Run(
      "INSERT INTO grooms (id, request_id, display_name, hair_type, seed, guide_count, "
      "element_count, longest_guide_m, has_scalp, etag, create_time_ns, import_summary, "
      "contact, hair_count, hair_point_count, hair_offset_unit_m) "
      "VALUES (?, nullif(?, ''), ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      record.id, record.request_id, record.display_name, record.hair_type, record.seed,
      record.guide_count, record.element_count, record.longest_guide_m, record.has_scalp,
      record.etag, record.create_time_ns, Blob{record.import_summary}, Blob{record.contact},
      record.hair_count, record.hair_point_count, record.hair_offset_unit_m);
  if (!inserted) return inserted;
  return database.Run("INSERT INTO groom_contents (groom_id, groom, rest) VALUES (?, ?, ?)",
                      record.id, Blob{content.groom}, Blob{content.rest});
}

Error NoSuchGroom(std::string_view id) {
  return {ErrorCode::kNotFound, fmt::format("there is no groom `grooms/{}`", id), ""};
}

}  // namespace

Result<std::unique_ptr<GroomStore>> GroomStore::Open(const std::filesystem::path& path) {
  auto database = Database::Open(path);
  if (!database) return database.error();
  return std::unique_ptr<GroomStore>(new GroomStore(std::move(*database)));
}

Result<GroomRecord> GroomStore::Put(const GroomRecord& record, const GroomContent& content) {
  if (record.id.empty()) return InvalidArgument("groom_id", "groom_id is empty");
  std::lock_guard lock(mutex_);
  auto transaction = Transaction::Begin(database_);
  if (!transaction) return transaction.error();

  auto earlier = FindByRequest(database_, record.request_id);
  if (!earlier) return earlier.error();
  if (*earlier) return std::move(**earlier);
  auto namesake = FindById(database_, record.id);
  if (!namesake) return namesake.error();
  if (*namesake) {
    return Error{ErrorCode::kAlreadyExists, fmt::format("`grooms/{}` already exists", record.id),
                 "groom_id"};
  }
  if (auto inserted = Insert(database_, record, content); !inserted) return inserted.error();
  if (auto committed = transaction->Commit(); !committed) return committed.error();
  return record;
}

Result<GroomRecord> GroomStore::Get(std::string_view id) {
  std::lock_guard lock(mutex_);
  auto found = FindById(database_, id);
  if (!found) return found.error();
  if (!*found) return NoSuchGroom(id);
  return std::move(**found);
}

Result<GroomContent> GroomStore::GetContent(std::string_view id) {
  std::lock_guard lock(mutex_);
  auto statement =
      database_.Prepare("SELECT groom, rest FROM groom_contents WHERE groom_id = ?", id);
  if (!statement) return statement.error();
  auto row = statement->Step();
  if (!row) return row.error();
  if (!*row) return NoSuchGroom(id);
  return GroomContent{statement->Bytes(0), statement->Bytes(1)};
}

Result<std::optional<GroomRecord>> GroomStore::FindByRequestId(std::string_view request_id) {
  std::lock_guard lock(mutex_);
  return FindByRequest(database_, request_id);
}

Result<Page<GroomRecord>> GroomStore::List(int page_size, std::string_view page_token) {
  if (auto checked = CheckPageSize(page_size); !checked) return checked.error();
  std::lock_guard lock(mutex_);
  // One more than the page tells whether there is a next one.
  auto statement = database_.Prepare(fmt::format("{} WHERE id > ? ORDER BY id LIMIT ?", kSelect),
                                     page_token, page_size + 1);
  if (!statement) return statement.error();
  Page<GroomRecord> page;
  while (true) {
    auto row = statement->Step();
    if (!row) return row.error();
    if (!*row) return page;
    if (static_cast<int>(page.records.size()) == page_size) {
      page.next_page_token = page.records.back().id;
      return page;
    }
    page.records.push_back(ReadRecord(*statement));
  }
}

Result<void> GroomStore::Delete(std::string_view id) {
  std::lock_guard lock(mutex_);
  if (auto deleted = database_.Run("DELETE FROM grooms WHERE id = ?", id); !deleted) return deleted;
  if (database_.ChangedRows() == 0) return NoSuchGroom(id);
  return {};
}

}  // namespace mane::storage
