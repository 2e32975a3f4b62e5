#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"
#include "storage/database.h"
#include "storage/page.h"

namespace mane::storage {

/// What describes a groom. The store keeps these numbers as given; it computes and checks none.
struct GroomRecord {
  std::string id;          ///< Last part of `grooms/{groom}`; unique.
  std::string request_id;  ///< That of the request that made it; unique, or empty for none.
  std::string display_name;
  int hair_type = 0;  ///< Number of mane.v1.HairType.
  uint64_t seed = 0;
  uint32_t guide_count = 0;
  uint32_t element_count = 0;  ///< Of all guides together.
  double longest_guide_m = 0;
  bool has_scalp = false;
  std::string etag;               ///< Digest of the content.
  int64_t create_time_ns = 0;     ///< Since the Unix epoch.
  std::string import_summary;     ///< Bytes; empty for a groom that was not imported.
  std::string contact;            ///< What its hair meets, as bytes; empty for nothing.
  uint32_t hair_count = 0;        ///< Hairs that ride on the guides.
  uint64_t hair_point_count = 0;  ///< Their control points.
  double hair_offset_unit_m = 0;  ///< Of their offsets; 0 without any.

  bool operator==(const GroomRecord&) const = default;
};

/// What a groom holds, as bytes that mean nothing to the store. Both together at most 1e9 bytes.
struct GroomContent {
  std::string groom;  ///< The serialised groom.
  std::string rest;   ///< Its solved rest shape.

  bool operator==(const GroomContent&) const = default;
};

/// The grooms on disk.
///
/// A groom that Put has returned survives the death of the process and of the machine, whole.
///
/// Threads: any; calls run one after the other on the store's own connection, and a writing call
///          returns when the disk has the data (milliseconds).
/// Errors:  besides those named, every call can fail as the disk does: kUnavailable, or
///          kResourceExhausted when it is full (see DatabaseError).
class GroomStore {
 public:
  /// Opens or creates the database file; see Database::Open for the errors.
  static Result<std::unique_ptr<GroomStore>> Open(const std::filesystem::path& path);

  /// Stores a groom and returns its record. When a groom of the same non-empty `request_id` is
  /// there, stores nothing and returns that one's record. ALREADY_EXISTS if `id` is taken;
  /// INVALID_ARGUMENT if `id` is empty.
  Result<GroomRecord> Put(const GroomRecord& record, const GroomContent& content);

  /// NOT_FOUND if there is none.
  Result<GroomRecord> Get(std::string_view id);
  /// NOT_FOUND if there is none.
  Result<GroomContent> GetContent(std::string_view id);
  /// The groom that `request_id` made; none for an empty or unknown one.
  Result<std::optional<GroomRecord>> FindByRequestId(std::string_view request_id);

  /// Grooms by id, at most `page_size` (1 to kMaxPageSize) of them, after the page that returned
  /// `page_token`; the first ones for an empty token. A groom that is there during the whole walk
  /// is listed once, whatever is put or deleted meanwhile.
  Result<Page<GroomRecord>> List(int page_size, std::string_view page_token);

  /// NOT_FOUND if there is none.
  Result<void> Delete(std::string_view id);

 private:
  explicit GroomStore(Database database) : database_(std::move(database)) {}

  std::mutex mutex_;
  Database database_;  // Guarded by mutex_.
};

}  // namespace mane::storage
