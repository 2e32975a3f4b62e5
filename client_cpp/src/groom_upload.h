#pragma once

#include <functional>

#include "mane/groom.h"
#include "mane/v1/groom.pb.h"

namespace mane::inline client {

/// Cuts an upload into the messages of a CreateGroom call, in order, each below 512 KiB whatever
/// the groom's size, and hands them to `write` one by one. Stops when it returns false.
void ForEachPart(const GroomUpload& upload,
                 const std::function<bool(const v1::CreateGroomRequest&)>& write);

}  // namespace mane::inline client
