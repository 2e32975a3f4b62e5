#pragma once

#include "beam/kernels.h"
#include "contact/meeting_kernels.h"
#include "rod/kernels.h"
#include "simd/isa.h"

namespace mane::head {

/// The kernels that this machine runs fastest, or MANE_ISA asks for.
[[nodiscard]] inline const rod::KernelTable<float>& Kernels() {
  static const rod::KernelTable<float>& kernels = rod::KernelsFor<float>(simd::Best());
  return kernels;
}

/// Likewise those of contact.
[[nodiscard]] inline const contact::MeetingKernels& Meetings() {
  static const contact::MeetingKernels& kernels = contact::MeetingKernelsFor(simd::Best());
  return kernels;
}

/// Likewise those of beams.
[[nodiscard]] inline const beam::KernelTable<float>& BeamKernels() {
  static const beam::KernelTable<float>& kernels = beam::KernelsFor<float>(simd::Best());
  return kernels;
}

}  // namespace mane::head
