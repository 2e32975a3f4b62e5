#include "session/beam_library.h"

namespace mane::session {

BeamLibrary::BeamsPtr BeamLibrary::FindLocked(const Asset& asset,
                                              const head::BeamOptions& options) const {
  for (const Entry& entry : entries_) {
    if (entry.groom.lock() != asset.groom) continue;
    BeamsPtr beams = entry.beams.lock();
    if (beams != nullptr && beams->options == options) return beams;
  }
  return nullptr;
}

BeamLibrary::BeamsPtr BeamLibrary::FindOrMake(const Asset& asset,
                                              const head::BeamOptions& options) {
  {
    std::lock_guard lock(mutex_);
    if (BeamsPtr found = FindLocked(asset, options)) return found;
  }
  BeamsPtr made = head::MakeBeams(*asset.groom, asset.bodies.get(), options, pool_);
  std::lock_guard lock(mutex_);
  if (BeamsPtr found = FindLocked(asset, options)) return found;
  std::erase_if(entries_, [](const Entry& entry) { return entry.beams.expired(); });
  entries_.push_back({asset.groom, made});
  return made;
}

}  // namespace mane::session
