#include "contact/field_cache.h"

#include <xxhash.h>

#include <random>

#include "base/check.h"

namespace mane::contact {
namespace {

uint64_t Secret() {
  std::random_device device;
  return uint64_t{device()} << 32 | device();
}

}  // namespace

FieldCache::FieldCache(const FieldOptions& options, size_t max_bytes, int workers)
    : options_(options), max_bytes_(max_bytes), secret_(Secret()), pool_(workers) {}

FieldCache::Key FieldCache::KeyOf(const TriangleMesh& mesh) const {
  static_assert(sizeof(Eigen::Vector3f) == 12 && sizeof(Triangle) == 12);
  const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(),
                                                                       XXH3_freeState);
  MANE_CHECK(state != nullptr && XXH3_128bits_reset_withSeed(state.get(), secret_) == XXH_OK);
  const auto add = [&](const void* data, size_t size) {
    MANE_CHECK(XXH3_128bits_update(state.get(), data, size) == XXH_OK);
  };
  const uint64_t sizes[2] = {mesh.vertices.size(), mesh.triangles.size()};
  add(sizes, sizeof sizes);
  add(mesh.vertices.data(), 12 * mesh.vertices.size());
  add(mesh.triangles.data(), 12 * mesh.triangles.size());
  const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
  return {hash.low64, hash.high64};
}

std::shared_ptr<FieldCache::Entry> FieldCache::FindOrAdd(const Key& key) {
  std::lock_guard lock(mutex_);
  auto& entry = entries_[key];
  if (entry == nullptr) {
    entry = std::make_shared<Entry>();
    by_use_.push_front(key);
    entry->place = by_use_.begin();
  } else {
    by_use_.splice(by_use_.begin(), by_use_, entry->place);
  }
  ++entry->asking;
  return entry;
}

void FieldCache::Drop(const Key& key) {
  const auto found = entries_.find(key);
  bytes_ -= found->second->bytes;
  by_use_.erase(found->second->place);
  entries_.erase(found);
}

// Counts a built field in, and drops what was used longest ago.
void FieldCache::CountIn(const Key& key, const Entry* entry, size_t bytes) {
  std::lock_guard lock(mutex_);
  const auto found = entries_.find(key);
  MANE_CHECK(found != entries_.end() && found->second.get() == entry);  // Not dropped before.
  found->second->bytes = bytes;
  bytes_ += bytes;
  if (bytes > max_bytes_) Drop(key);
  for (auto place = by_use_.end(); bytes_ > max_bytes_;) {
    const Key oldest = *--place;
    if (entries_.at(oldest)->bytes == 0) continue;  // Being built.
    ++place;
    Drop(oldest);
  }
}

// The last one out drops what is not built: refused, or not wanted any more.
void FieldCache::Leave(const Key& key, Entry* entry) {
  std::lock_guard lock(mutex_);
  if (--entry->asking == 0 && entry->bytes == 0) Drop(key);
}

Result<std::shared_ptr<const MeshField>> FieldCache::Get(const TriangleMesh& mesh,
                                                         const base::Cancelled& cancelled) {
  const Key key = KeyOf(mesh);
  const std::shared_ptr<Entry> entry = FindOrAdd(key);
  auto field = entry->field.Get(cancelled, [&](const base::Cancelled& unwanted) {
    auto built = MeshField::Build(mesh, options_, &pool_, unwanted);
    if (built) CountIn(key, entry.get(), (*built)->bytes());
    return built;
  });
  Leave(key, entry.get());
  return field;
}

size_t FieldCache::bytes() const {
  std::lock_guard lock(mutex_);
  return bytes_;
}

size_t FieldCache::size() const {
  std::lock_guard lock(mutex_);
  return entries_.size();
}

}  // namespace mane::contact
