#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "base/result.h"

namespace mane::storage {

inline constexpr int kMaxPageSize = 1000;

/// One page of a listing.
template <typename Record>
struct Page {
  std::vector<Record> records;
  std::string next_page_token;  ///< Where the next page begins; empty on the last page.
};

/// INVALID_ARGUMENT unless `page_size` is in [1, kMaxPageSize].
[[nodiscard]] inline Result<void> CheckPageSize(int page_size) {
  if (page_size >= 1 && page_size <= kMaxPageSize) return {};
  return InvalidArgument(
      "page_size", fmt::format("page_size is {}; it must be in [1, {}]", page_size, kMaxPageSize));
}

}  // namespace mane::storage
