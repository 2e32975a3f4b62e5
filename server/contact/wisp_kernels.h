#pragma once

#include "contact/wisp_layout.h"
#include "simd/isa.h"

namespace mane::contact {

/// Kernels for an instruction set that simd::Supported() lists.
[[nodiscard]] const WispKernels& WispKernelsFor(simd::Isa isa);

}  // namespace mane::contact
