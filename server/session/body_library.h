#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <mutex>

#include "base/cancelled.h"
#include "base/result.h"
#include "contact/field_cache.h"
#include "exec/joint.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/bodies.h"

namespace mane::session {

struct BodyLibraryOptions {
  contact::FieldOptions field;
  /// Of distance fields that are kept though nobody uses them [bytes].
  size_t max_kept_bytes = size_t{1} << 30;
  /// Of the fields of all bodies that are here, and of hair that settled among them [bytes]: those
  /// that no head uses make room, and a groom that still comes on top is refused. One mesh in
  /// several grooms counts once.
  size_t max_used_bytes = size_t{4} << 30;
  int workers = 1;  ///< That build a field together, >= 1.
};

/// What the hair of grooms meets, ready for contact: made when a head first needs it, and kept
/// while its groom is in memory, for all heads of that groom.
///
/// Threads: every method from any thread. `mutex_` guards what stands below it and is not held
/// while fields are built and hair settles, which takes seconds; who asks for the same groom or
/// mesh meanwhile waits for that, and it stops when nobody waits any more.
class BodyLibrary {
 public:
  using GroomPtr = std::shared_ptr<const groom::Groom>;
  using BodiesPtr = std::shared_ptr<const head::Bodies>;

  explicit BodyLibrary(const BodyLibraryOptions& options)
      : options_(options), fields_(options.field, options.max_kept_bytes, options.workers) {}

  /// Where to make or wait for the bodies of `groom`, for those who should not on their own thread:
  /// kMakers at once. Those that may take long, with meshes or much hair, have threads of their
  /// own, so that quick ones need not wait for them, however many there are.
  static constexpr int kMakers = 4;
  [[nodiscard]] exec::WorkerPool& PoolFor(const groom::Groom& groom);
  /// Waits until nothing posted there is waiting or running.
  void WaitIdle() { quick_.WaitIdle(), slow_.WaitIdle(); }

  /// Whether FindOrMake(groom) would have to make them.
  [[nodiscard]] bool Missing(const GroomPtr& groom);

  /// Bodies of `groom`, null where it has none. @return head::MakeBodies' errors;
  ///   RESOURCE_EXHAUSTED naming nothing above max_used_bytes; kCancelled as exec::Joint.
  [[nodiscard]] Result<BodiesPtr> FindOrMake(const GroomPtr& groom,
                                             const base::Cancelled& cancelled = {});

  /// head::MakeShapes: tries whether FindOrMake could make them; the fields are kept.
  [[nodiscard]] Result<std::shared_ptr<head::Bodies>> MakeShapes(
      const groom::Groom& groom, const base::Cancelled& cancelled = {}) {
    return head::MakeShapes(groom, &fields_, cancelled);
  }

 private:
  using Key = std::weak_ptr<const groom::Groom>;

  struct Entry {
    BodiesPtr bodies;
    uint64_t used = 0;  // When it was last asked for.
  };

  using Making = exec::Joint<BodiesPtr>;

  // Takes over what was made.
  [[nodiscard]] Result<BodiesPtr> Add(const GroomPtr& groom, const BodiesPtr& made);
  [[nodiscard]] BodiesPtr FindLocked(const GroomPtr& groom);
  // Of the fields and the settled hair of all bodies that are here, and of `more`.
  [[nodiscard]] size_t BytesLocked(const BodiesPtr& more) const;
  // Drops the one used longest ago of those that no head uses; false where there is none.
  bool DropOneLocked();

  const BodyLibraryOptions options_;
  contact::FieldCache fields_;
  // Hair settles on it. Nobody waits for what is made on it: tasks of quick_ and slow_ do, and
  // would leave the maker no thread of their own pool.
  exec::WorkerPool settling_{kMakers};

  std::mutex mutex_;
  std::map<Key, Entry, std::owner_less<Key>> bodies_;
  std::map<Key, std::weak_ptr<Making>, std::owner_less<Key>> makings_;  // Under way.
  uint64_t clock_ = 0;                                                  // Counts what is asked for.

  exec::WorkerPool quick_{kMakers}, slow_{kMakers};  // Last: their tasks use the rest.
};

}  // namespace mane::session
