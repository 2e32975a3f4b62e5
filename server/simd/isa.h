#pragma once

#include <span>
#include <string_view>

#include "base/result.h"

namespace mane::simd {

/// Instruction sets that kernels are compiled for, slowest first. One binary holds all that its
/// architecture has; which of them the machine can run is known at run time only.
enum class Isa { kScalar, kNeon, kAvx2, kAvx512 };

/// What it is called: "scalar", "neon", "avx2", "avx512".
[[nodiscard]] std::string_view Name(Isa isa);

/// What this machine can run, slowest first; always begins with kScalar. kAvx2 includes FMA,
/// kAvx512 the subsets F, BW, DQ and VL.
[[nodiscard]] std::span<const Isa> Supported();

/// The supported set called `name`, or the fastest one for an empty name. INVALID_ARGUMENT (field
/// MANE_ISA) where this machine has none of that name.
[[nodiscard]] Result<Isa> Choose(std::string_view name);

/// What kernels use: Choose of the environment variable MANE_ISA at the first call, which must be a
/// valid choice.
[[nodiscard]] Isa Best();

}  // namespace mane::simd
