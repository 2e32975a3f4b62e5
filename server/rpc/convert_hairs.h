#pragma once

#include <cstddef>

#include "base/result.h"
#include "groom/hairs.h"
#include "mane/v1/groom.pb.h"

namespace mane::rpc {

/// Hairs of groom.proto to the domain and back. groom::ValidateHairs checks what they say; what
/// only the encoding can get wrong is checked here.

/// Appends a batch to `hairs`. kInvalidArgument naming `hairs.` and the list for bytes that are no
/// whole number of entries or do not fit the other lists, colours of earlier batches among them.
[[nodiscard]] Result<void> AppendHairs(const v1::HairBatch& batch, groom::Hairs* hairs);

/// The hairs from `begin` to before `end`.
void FromHairs(const groom::Hairs& hairs, size_t begin, size_t end, v1::HairBatch* batch);

/// The end of a batch that begins with hair `begin`: as many hairs as take 512 KiB, at least one.
[[nodiscard]] size_t EndOfBatch(const groom::Hairs& hairs, size_t begin);

}  // namespace mane::rpc
