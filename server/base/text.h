#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace mane::base {

/// A caller's `text` for a message: its beginning, 126 bytes at most, as it is; every byte that is
/// no part of a character of UTF-8 and every control character are replaced by `?`.
[[nodiscard]] std::string Shown(std::string_view text);

/// Whether `text` is 1 to `most` of a-z, 0-9 and `others`, and begins and ends with one of the
/// first two.
[[nodiscard]] inline bool IsIdentifier(std::string_view text, size_t most,
                                       std::string_view others) {
  const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); };
  return !text.empty() && text.size() <= most && plain(text.front()) && plain(text.back()) &&
         std::ranges::all_of(text,
                             [&](char c) { return plain(c) || others.find(c) != others.npos; });
}

}  // namespace mane::base
