#include "session/body_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <variant>
#include <vector>

#include "session/admission.h"

namespace mane::session {
namespace {

size_t SettledBytes(const head::Bodies& bodies) {
  return (bodies.settled.size() + bodies.settled_memory.size()) * sizeof(bodies.settled[0]);
}

// Element-steps of a step with which hair takes long to settle: in a thousand of them, about two
// seconds of one core.
constexpr double kSlowSteps = 5e4;

// Whether hair meets a mesh: its distance field may take half a minute, whatever its triangles.
bool MeetsMesh(const groom::Groom& groom) {
  const bool scalp =
      groom.scalp_friction && std::holds_alternative<groom::TriangleMesh>(groom.scalp);
  return scalp || std::ranges::any_of(groom.bodies, [](const groom::Body& body) {
           return std::holds_alternative<std::shared_ptr<const groom::Body::Mesh>>(body.shape);
         });
}

}  // namespace

exec::WorkerPool& BodyLibrary::PoolFor(const groom::Groom& groom) {
  return MeetsMesh(groom) || StepWork(groom, 1) > kSlowSteps ? slow_ : quick_;
}

bool BodyLibrary::Missing(const GroomPtr& groom) {
  std::lock_guard lock(mutex_);
  return groom->has_contact && FindLocked(groom) == nullptr;
}

Result<BodyLibrary::BodiesPtr> BodyLibrary::FindOrMake(const GroomPtr& groom,
                                                       const base::Cancelled& cancelled) {
  if (!groom->has_contact) return BodiesPtr();
  std::shared_ptr<Making> making;
  {
    std::lock_guard lock(mutex_);
    if (BodiesPtr found = FindLocked(groom)) return found;
    std::erase_if(makings_, [](const auto& item) { return item.second.expired(); });
    std::weak_ptr<Making>& known = makings_[groom];
    making = known.lock();
    if (making == nullptr) known = making = std::make_shared<Making>();
  }
  return making->Get(cancelled, [&](const base::Cancelled& unwanted) -> Result<BodiesPtr> {
    auto made = head::MakeBodies(*groom, &fields_, settling_, unwanted);
    if (!made) return made;
    return Add(groom, *made);
  });
}

Result<BodyLibrary::BodiesPtr> BodyLibrary::Add(const GroomPtr& groom, const BodiesPtr& made) {
  std::lock_guard lock(mutex_);
  if (BodiesPtr found = FindLocked(groom)) return found;  // Another one was faster.
  std::erase_if(bodies_, [](const auto& item) { return item.first.expired(); });
  for (size_t bytes; (bytes = BytesLocked(made)) > options_.max_used_bytes;) {
    if (DropOneLocked()) continue;
    return Error{
        ErrorCode::kResourceExhausted,
        fmt::format("with what this groom's hair meets and remembers, distance fields and "
                    "settled hair in use would take {} bytes; the server has {}: try again "
                    "when other heads are closed, or another server",
                    bytes, options_.max_used_bytes),
        ""};
  }
  bodies_[groom] = {made, ++clock_};
  return made;
}

BodyLibrary::BodiesPtr BodyLibrary::FindLocked(const GroomPtr& groom) {
  const auto found = bodies_.find(groom);
  if (found == bodies_.end()) return nullptr;
  found->second.used = ++clock_;
  return found->second.bodies;
}

size_t BodyLibrary::BytesLocked(const BodiesPtr& more) const {
  std::vector<head::Bodies::Body> all = more->bodies;  // Shares the fields.
  size_t settled = SettledBytes(*more);
  for (const auto& [groom, entry] : bodies_) {
    all.insert(all.end(), entry.bodies->bodies.begin(), entry.bodies->bodies.end());
    settled += SettledBytes(*entry.bodies);
  }
  return head::FieldBytes(all) + settled;
}

bool BodyLibrary::DropOneLocked() {
  auto oldest = bodies_.end();
  for (auto item = bodies_.begin(); item != bodies_.end(); ++item) {
    if (item->second.bodies.use_count() > 1)
      continue;  // A copy is made only under mutex_, or of one.
    if (oldest == bodies_.end() || item->second.used < oldest->second.used) oldest = item;
  }
  if (oldest == bodies_.end()) return false;
  bodies_.erase(oldest);
  return true;
}

}  // namespace mane::session
