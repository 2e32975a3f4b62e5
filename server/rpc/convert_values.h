#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cstring>
#include <string>
#include <vector>

#include "base/result.h"
#include "mane/v1/types.pb.h"

namespace mane::rpc {

/// Numbers of types.proto to the domain and back, unchecked, and lists of packed little-endian
/// numbers (this program runs on little-endian machines only; see wire).

[[nodiscard]] inline Eigen::Vector3d ToVector(const v1::Vector3& message) {
  return {message.x(), message.y(), message.z()};
}

inline void FromVector(const Eigen::Vector3d& v, v1::Vector3* message) {
  message->set_x(v.x());
  message->set_y(v.y());
  message->set_z(v.z());
}

[[nodiscard]] inline Eigen::Quaterniond ToQuaternion(const v1::Quaternion& message) {
  return {message.w(), message.x(), message.y(), message.z()};
}

inline void FromQuaternion(const Eigen::Quaterniond& q, v1::Quaternion* message) {
  message->set_x(q.x());
  message->set_y(q.y());
  message->set_z(q.z());
  message->set_w(q.w());
}

/// Appends what `bytes` hold to `entries`; kInvalidArgument naming `field` when they are no whole
/// number of entries.
template <typename Entry>
Result<void> AppendBytes(const std::string& bytes, const std::string& field,
                         std::vector<Entry>* entries) {
  if (bytes.size() % sizeof(Entry) != 0) {
    return InvalidArgument(field, fmt::format("{} has {} bytes; it must be a multiple of {}", field,
                                              bytes.size(), sizeof(Entry)));
  }
  const size_t before = entries->size();
  entries->resize(before + bytes.size() / sizeof(Entry));
  std::memcpy(static_cast<void*>(entries->data() + before), bytes.data(), bytes.size());
  return {};
}

/// Entries from `begin` on, `count` of them or as many as there are, as bytes.
template <typename Entry>
void FromEntries(const std::vector<Entry>& entries, size_t begin, size_t count,
                 std::string* bytes) {
  begin = std::min(begin, entries.size());
  count = std::min(count, entries.size() - begin);
  bytes->assign(reinterpret_cast<const char*>(entries.data() + begin), count * sizeof(Entry));
}

}  // namespace mane::rpc
