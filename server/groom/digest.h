#pragma once

#include <string>

#include "groom/groom.h"

namespace mane::groom {

/// Digest of what an author gave: display name, hair type, seed, scalp, guides, what they
/// meet, and hairs; equal content, equal digest. XXH3 with 128 bits over the fields in the order of
/// their declaration, lists after their sizes, as little-endian numbers; 32 lowercase hexadecimal
/// digits. Not cryptographic: who may upload grooms can make two with one digest.
[[nodiscard]] std::string Digest(const Groom& groom);

}  // namespace mane::groom
