#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "exec/worker_pool.h"
#include "head/beams.h"
#include "session/asset.h"

namespace mane::session {

/// Grooms as beams, each shared by the heads that want the same options of it, and kept while one
/// of them is there: clients choose options freely, so that they are not kept with the groom, as
/// LevelLibrary keeps levels.
///
/// Threads: every method from any thread. `mutex_` guards what stands below it and is not held
/// while beams are made: who asks meanwhile makes them too, the same ones, and gets those that
/// were ready first.
class BeamLibrary {
 public:
  using BeamsPtr = std::shared_ptr<const head::Beams>;

  /// Beams are made on `pool`, which should not be that of real-time heads: it takes up to a second
  /// for large grooms.
  explicit BeamLibrary(exec::WorkerPool& pool) : pool_(pool) {}

  [[nodiscard]] exec::WorkerPool& pool() { return pool_; }

  /// Beams of the asset's groom, made now unless they are there.
  [[nodiscard]] BeamsPtr FindOrMake(const Asset& asset, const head::BeamOptions& options);

 private:
  struct Entry {
    std::weak_ptr<const groom::Groom> groom;
    std::weak_ptr<const head::Beams> beams;
  };
  [[nodiscard]] BeamsPtr FindLocked(const Asset& asset, const head::BeamOptions& options) const;

  exec::WorkerPool& pool_;

  std::mutex mutex_;
  std::vector<Entry> entries_;
};

}  // namespace mane::session
