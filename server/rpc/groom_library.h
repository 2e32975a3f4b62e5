#pragma once

#include <list>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "base/cancelled.h"
#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/assemble.h"
#include "groom/limits.h"
#include "mane/v1/groom.pb.h"
#include "session/asset.h"
#include "session/body_library.h"
#include "storage/groom_store.h"
#include "stored.pb.h"

namespace mane::rpc {

/// Grooms between their bytes on disk and the shared values that heads animate. What was used last
/// stays in memory, so that many heads on one groom share it and open at once.
///
/// A groom is always built from its stored bytes, so that its bits do not depend on whether it was
/// just made or read after a restart.
///
/// Threads: any. `mutex_` is not held while a groom is read.
class GroomLibrary {
 public:
  GroomLibrary(storage::GroomStore& store, exec::WorkerPool& pool, session::BodyLibrary& bodies,
               const groom::Limits& limits)
      : store_(store), pool_(pool), bodies_(bodies), limits_(limits) {}

  [[nodiscard]] storage::GroomStore& store() { return store_; }
  [[nodiscard]] const groom::Limits& limits() const { return limits_; }
  [[nodiscard]] exec::WorkerPool& pool() { return pool_; }

  /// What an upload leaves to be stored.
  struct Draft {
    std::string id;  ///< Empty to choose one.
    std::string request_id;
    groom::Parts parts;
    std::optional<v1::ImportReport> import_report;  ///< Of a groom made from strands.
    StoredContact contact;                          ///< PrepareContact's of its parts.
  };
  /// Makes what hair of `parts` meets and tells of it. Comes before guides are made and rest shapes
  /// solved, so that a mesh that cannot be used is refused at once. Errors name the field;
  /// kCancelled soon after `cancelled` says so.
  Result<StoredContact> PrepareContact(const groom::Parts& parts,
                                       const base::Cancelled& cancelled = {});
  /// The shapes of what hair of `parts` meets: its bodies, and its scalp where it has a friction.
  /// Fields of meshes are kept. Errors as head::MakeShapes.
  Result<std::shared_ptr<head::Bodies>> MakeShapes(const groom::Parts& parts,
                                                   const base::Cancelled& cancelled = {});
  /// Solves the rest shape and stores both; on disk when it returns. Taken() where there is a groom
  /// of that id.
  Result<storage::GroomRecord> Create(Draft draft);

  /// ALREADY_EXISTS naming `header.groom_id`.
  [[nodiscard]] static Error Taken(const std::string& id);

  /// The groom called `name`; errors name `field`. kNotFound if there is none.
  Result<std::shared_ptr<const groom::Groom>> Load(const std::string& name,
                                                   const std::string& field);

  /// The same with what its hair meets, for heads. Takes seconds where distance fields of meshes
  /// must be made (MakersOf). kResourceExhausted when these in use would be too large;
  /// kCancelled soon after `cancelled` says so.
  Result<session::Asset> LoadAsset(const std::string& name, const std::string& field,
                                   const base::Cancelled& cancelled = {});
  /// The same for a `groom` that Load gave.
  Result<session::Asset> MakeAsset(std::shared_ptr<const groom::Groom> groom,
                                   const std::string& field, const base::Cancelled& cancelled);

  /// The pool to wait on where LoadAsset may take that long, as what hair meets is not made yet;
  /// null where it is, and for a groom that is not there.
  [[nodiscard]] exec::WorkerPool* MakersOf(const std::string& name);

  /// The report of the groom called `name`; errors name `field`. kNotFound if there is no groom,
  /// kFailedPrecondition if it was not made from strands.
  Result<v1::ImportReport> LoadImportReport(const std::string& name, const std::string& field);

 private:
  // Grooms kept beyond their last head; the most recent first.
  static constexpr size_t kKept = 16;

  // The description of the groom called `name`; errors name `field`.
  Result<storage::GroomRecord> Find(const std::string& name, const std::string& field);
  Result<std::shared_ptr<const groom::Groom>> Read(const storage::GroomRecord& record);

  storage::GroomStore& store_;
  exec::WorkerPool& pool_;
  session::BodyLibrary& bodies_;
  const groom::Limits limits_;

  std::mutex mutex_;
  // By id and etag, so that a groom deleted and made anew under its old name is another one.
  std::list<std::pair<std::string, std::shared_ptr<const groom::Groom>>> recent_;
};

}  // namespace mane::rpc
