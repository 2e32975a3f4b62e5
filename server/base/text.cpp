#include "base/text.h"

#include <cstdint>

namespace mane::base {
namespace {

constexpr size_t kMostShown = 126;  // Bytes.

// Bytes of the character at the beginning of `text`, which is not empty; 0 where there is none.
size_t CharacterBytes(std::string_view text) {
  const auto byte = [&](size_t i) { return static_cast<uint8_t>(text[i]); };
  if (byte(0) < 0x80) return 1;
  const size_t bytes = byte(0) >= 0xf0 ? 4 : byte(0) >= 0xe0 ? 3 : 2;
  if (byte(0) < 0xc2 || byte(0) > 0xf4 || bytes > text.size()) return 0;
  for (size_t i = 1; i < bytes; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  // Not the shortest form, half of a pair, or past the last character.
  const bool wrong = (byte(0) == 0xe0 && byte(1) < 0xa0) || (byte(0) == 0xed && byte(1) >= 0xa0) ||
                     (byte(0) == 0xf0 && byte(1) < 0x90) || (byte(0) == 0xf4 && byte(1) >= 0x90);
  return wrong ? 0 : bytes;
}

bool IsControl(std::string_view character) {
  const auto first = static_cast<uint8_t>(character[0]);
  if (first == 0xc2) return static_cast<uint8_t>(character[1]) < 0xa0;
  return first < 0x20 || first == 0x7f;
}

}  // namespace

std::string Shown(std::string_view text) {
  std::string shown;
  while (!text.empty()) {
    const size_t bytes = std::max<size_t>(1, CharacterBytes(text));
    if (shown.size() + bytes > kMostShown) break;
    const std::string_view character = text.substr(0, bytes);
    if (CharacterBytes(text) == 0 || IsControl(character)) {
      shown += '?';
    } else {
      shown += character;
    }
    text.remove_prefix(bytes);
  }
  return shown;
}

}  // namespace mane::base
