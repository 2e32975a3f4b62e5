#include "session/body_library.h"

#include <fmt/format.h>

namespace mane::session {
namespace {

bool HasBodies(const groom::Groom& groom) { return !groom.bodies.empty() || groom.scalp_friction; }

}  // namespace

bool BodyLibrary::Missing(const GroomPtr& groom) {
  std::lock_guard lock(mutex_);
  return HasBodies(*groom) && FindLocked(groom) == nullptr;
}

Result<BodyLibrary::BodiesPtr> BodyLibrary::FindOrMake(const GroomPtr& groom) {
  if (!HasBodies(*groom)) return BodiesPtr();
  {
    std::lock_guard lock(mutex_);
    if (BodiesPtr found = FindLocked(groom)) return found;
  }
  auto made = Make(*groom);
  if (!made) return made;
  std::lock_guard lock(mutex_);
  if (BodiesPtr found = FindLocked(groom)) return found;  // Another one was faster.
  std::erase_if(bodies_, [](const auto& item) { return item.second.expired(); });
  const size_t bytes = UsedBytesLocked(*made);
  if (bytes > options_.max_used_bytes) {
    return Error{ErrorCode::kResourceExhausted,
                 fmt::format("with the meshes that this groom's hair meets, distance fields in use "
                             "would take {} bytes; the server has {}: try again when other heads "
                             "are closed, or another server",
                             bytes, options_.max_used_bytes),
                 ""};
  }
  bodies_[groom] = *made;
  return made;
}

Result<BodyLibrary::BodiesPtr> BodyLibrary::Make(const groom::Groom& groom) {
  return head::MakeBodies(groom, &fields_);
}

BodyLibrary::BodiesPtr BodyLibrary::FindLocked(const GroomPtr& groom) const {
  const auto found = bodies_.find(groom);
  return found == bodies_.end() ? nullptr : found->second.lock();
}

size_t BodyLibrary::UsedBytesLocked(const BodiesPtr& more) const {
  std::vector<head::Bodies::Body> all = more->bodies;  // Shares the fields.
  for (const auto& [groom, bodies] : bodies_) {
    const BodiesPtr alive = bodies.lock();
    if (alive != nullptr) all.insert(all.end(), alive->bodies.begin(), alive->bodies.end());
  }
  return head::FieldBytes(all);
}

}  // namespace mane::session
