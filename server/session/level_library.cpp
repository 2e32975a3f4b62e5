#include "session/level_library.h"

namespace mane::session {

LevelLibrary::LevelsPtr LevelLibrary::Find(const GroomPtr& groom) {
  std::lock_guard lock(mutex_);
  const auto found = levels_.find(groom);
  return found == levels_.end() ? nullptr : found->second;
}

LevelLibrary::LevelsPtr LevelLibrary::FindOrMake(const GroomPtr& groom) {
  if (LevelsPtr found = Find(groom)) return found;
  const auto made = std::make_shared<const head::Levels>(*groom, pool_);
  std::lock_guard lock(mutex_);
  std::erase_if(levels_, [](const auto& item) { return item.first.expired(); });
  return levels_.emplace(groom, made).first->second;
}

}  // namespace mane::session
