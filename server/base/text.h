#pragma once

#include <algorithm>
#include <string>
#include <string_view>

namespace mane::base {

/// A caller's `text` for a message: its beginning, with everything but printable ASCII
/// replaced by `?`, so that a cut through a character leaves valid UTF-8.
[[nodiscard]] inline std::string Shown(std::string_view text) {
  std::string shown(text.substr(0, 126));
  std::ranges::replace_if(
      shown, [](char c) { return c < ' ' || c > '~'; }, '?');
  return shown;
}

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
