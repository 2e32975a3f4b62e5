#pragma once

#include <map>
#include <memory>
#include <mutex>

#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/levels.h"

namespace mane::session {

/// The levels of detail of grooms, each made when a head first needs it and kept while its groom is
/// in use, for all heads of that groom.
///
/// Threads: every method from any thread. `mutex_` guards what stands below it and is not held
/// while levels are made: who asks meanwhile makes them too, the same ones, and gets those that
/// were ready first.
class LevelLibrary {
 public:
  using GroomPtr = std::shared_ptr<const groom::Groom>;
  using LevelsPtr = std::shared_ptr<const head::Levels>;

  /// Levels are made on `pool`, which should not be that of real-time heads: it takes seconds for
  /// large grooms (head::Levels).
  explicit LevelLibrary(exec::WorkerPool& pool) : pool_(pool) {}

  [[nodiscard]] exec::WorkerPool& pool() { return pool_; }

  /// The levels of `groom`; null while there are none.
  [[nodiscard]] LevelsPtr Find(const GroomPtr& groom);
  /// The levels of `groom`, made now unless they are there.
  [[nodiscard]] LevelsPtr FindOrMake(const GroomPtr& groom);

 private:
  using Key = std::weak_ptr<const groom::Groom>;

  exec::WorkerPool& pool_;

  std::mutex mutex_;
  std::map<Key, LevelsPtr, std::owner_less<Key>> levels_;
};

}  // namespace mane::session
