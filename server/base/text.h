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

}  // namespace mane::base
