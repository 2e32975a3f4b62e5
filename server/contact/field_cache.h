#pragma once

#include <cstdint>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include "contact/mesh_field.h"
#include "exec/joint.h"

namespace mane::contact {

/// Fields by the content of their meshes: the same mesh gives the same shared field.
///
/// Keeps what was used last, up to a number of bytes; what is dropped lives on with those who hold
/// it. Those who ask for one mesh at once wait for one build, which stops when all of them have
/// gone. Refused meshes are not remembered.
///
/// The digest, XXH3 with 128 bits, is mixed with a secret of the process, so that nobody can make
/// a mesh that takes the place of another's.
///
/// Threads: Get may be called from any, also from workers of any other pool. `mutex_` guards the
/// list and the sizes; nobody waits for a build under `mutex_`. The pool that builds is the cache's
/// own: were it one whose tasks call Get, they could all wait for a builder who waits for a place
/// in it.
class FieldCache {
 public:
  /// @param max_bytes  of the fields kept; one that alone is larger is not kept.
  /// @param workers    threads that build at once, >= 1, those who ask among them.
  FieldCache(const FieldOptions& options, size_t max_bytes, int workers);

  /// The field of `mesh`, built if it is not there. @return MeshField::Build's errors; kCancelled
  ///   as exec::Joint.
  [[nodiscard]] Result<std::shared_ptr<const MeshField>> Get(const TriangleMesh& mesh,
                                                             const base::Cancelled& cancelled = {});

  [[nodiscard]] size_t bytes() const;
  [[nodiscard]] size_t size() const;

 private:
  using Key = std::pair<uint64_t, uint64_t>;
  struct Entry {
    exec::Joint<std::shared_ptr<const MeshField>> field;
    // Guarded by the cache's mutex_.
    int asking = 0;                  // Who are in Get.
    size_t bytes = 0;                // 0 until it is built.
    std::list<Key>::iterator place;  // In by_use_.
  };

  [[nodiscard]] Key KeyOf(const TriangleMesh& mesh) const;
  std::shared_ptr<Entry> FindOrAdd(const Key& key);
  void CountIn(const Key& key, const Entry* entry, size_t bytes);
  void Leave(const Key& key, Entry* entry);
  void Drop(const Key& key);

  const FieldOptions options_;
  const size_t max_bytes_;
  const uint64_t secret_;
  exec::WorkerPool pool_;
  mutable std::mutex mutex_;
  // Guarded by mutex_.
  std::map<Key, std::shared_ptr<Entry>> entries_;
  std::list<Key> by_use_;  // Last used first.
  size_t bytes_ = 0;
};

}  // namespace mane::contact
