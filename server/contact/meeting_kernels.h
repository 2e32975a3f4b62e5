#pragma once

#include "contact/meeting_layout.h"
#include "simd/isa.h"

namespace mane::contact {

/// Kernels for an instruction set that simd::Supported() lists.
[[nodiscard]] const MeetingKernels& MeetingKernelsFor(simd::Isa isa);

}  // namespace mane::contact
