#pragma once

/// The names of lanes that kernels of rods use; only for sources that define MANE_ISA.

#include "rod/batch_layout.h"
#include "simd/lanewise.h"

namespace mane::rod {
namespace MANE_ISA {

using simd::MANE_ISA::Factor;
using simd::MANE_ISA::Frame;
using simd::MANE_ISA::Lanewise;
using simd::MANE_ISA::Lower;
using simd::MANE_ISA::Matrix;
using simd::MANE_ISA::Symmetric;
using simd::MANE_ISA::Vector;

}  // namespace MANE_ISA
}  // namespace mane::rod
