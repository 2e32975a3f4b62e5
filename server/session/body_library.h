#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "base/result.h"
#include "contact/field_cache.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/bodies.h"

namespace mane::session {

struct BodyLibraryOptions {
  contact::FieldOptions field;
  /// Of distance fields that are kept though nobody uses them [bytes].
  size_t max_kept_bytes = size_t{1} << 30;
  /// Of all fields that heads use [bytes], those among them that are kept: a groom whose fields
  /// come on top is refused. One mesh in several grooms counts once.
  size_t max_used_bytes = size_t{4} << 30;
  int workers = 1;  ///< That build a field together, >= 1.
};

/// What the hair of grooms meets, ready for contact: made when a head first needs it, and shared by
/// all heads of its groom while one of them lives.
///
/// Threads: every method from any thread. `mutex_` guards what stands below it and is not held
/// while fields are built, which takes seconds; who asks for the same mesh meanwhile waits.
class BodyLibrary {
 public:
  using GroomPtr = std::shared_ptr<const groom::Groom>;
  using BodiesPtr = std::shared_ptr<const head::Bodies>;

  explicit BodyLibrary(const BodyLibraryOptions& options)
      : options_(options), fields_(options.field, options.max_kept_bytes, options.workers) {}

  /// For those who should not wait themselves: builds are FindOrMake's, one after the other.
  [[nodiscard]] exec::WorkerPool& pool() { return pool_; }

  /// Whether FindOrMake(groom) would have to make them.
  [[nodiscard]] bool Missing(const GroomPtr& groom);

  /// Bodies of `groom`, null where it has none. @return head::MakeBodies' errors;
  ///   RESOURCE_EXHAUSTED naming nothing above max_used_bytes.
  [[nodiscard]] Result<BodiesPtr> FindOrMake(const GroomPtr& groom);

  /// Bodies of a groom of which only scalp, bodies and friction need to be there, as FindOrMake has
  /// them; they are not remembered, but their fields are kept.
  [[nodiscard]] Result<BodiesPtr> Make(const groom::Groom& groom);

 private:
  using Key = std::weak_ptr<const groom::Groom>;

  [[nodiscard]] BodiesPtr FindLocked(const GroomPtr& groom) const;
  // Of the fields of all bodies that live, and of `more`.
  [[nodiscard]] size_t UsedBytesLocked(const BodiesPtr& more) const;

  const BodyLibraryOptions options_;
  contact::FieldCache fields_;

  mutable std::mutex mutex_;
  std::map<Key, std::weak_ptr<const head::Bodies>, std::owner_less<Key>> bodies_;

  exec::WorkerPool pool_{1};  // Last: its tasks use the rest.
};

}  // namespace mane::session
