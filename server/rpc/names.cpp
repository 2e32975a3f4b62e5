#include "rpc/names.h"

#include <sys/random.h>

#include "base/check.h"
#include "base/text.h"

namespace mane::rpc {
namespace {

constexpr size_t kMaxId = 63;

}  // namespace

Result<void> CheckId(const std::string& id, const std::string& field) {
  if (base::IsIdentifier(id, kMaxId, "-")) return {};
  return InvalidArgument(field, fmt::format("{} is \"{}\"; it must be 1 to {} of a-z, 0-9 and -, "
                                            "and begin and end with a letter or digit",
                                            field, base::Shown(id), kMaxId));
}

Result<std::string> ParseName(const std::string& name, std::string_view collection,
                              const std::string& field) {
  const std::string prefix = std::string(collection) + "/";
  if (name.starts_with(prefix)) {
    const std::string id = name.substr(prefix.size());
    if (CheckId(id, field)) return id;
  }
  return InvalidArgument(field, fmt::format("{} is \"{}\"; it must be a name of the form {}{{id}}",
                                            field, base::Shown(name), prefix));
}

std::string RandomId() {
  uint64_t bits = 0;
  MANE_CHECK(getrandom(&bits, sizeof bits, 0) == sizeof bits);
  return fmt::format("{:016x}", bits);
}

Result<void> CheckText(const std::string& text, size_t max_bytes, const std::string& field) {
  if (text.size() <= max_bytes) return {};
  return InvalidArgument(
      field, fmt::format("{} has {} bytes; at most {} are allowed", field, text.size(), max_bytes));
}

}  // namespace mane::rpc
