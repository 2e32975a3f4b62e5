#pragma once

#include "mane/v1/style.pb.h"

namespace mane::rpc {

/// Adds beam::BeamPresets as `beam-NAME`, moved from their hull to that of a head of human size
/// whose pivot is the origin.
void AddBeamPresets(v1::ListStylePresetsResponse* response);

}  // namespace mane::rpc
