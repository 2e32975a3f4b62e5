#include "contact/wisp_kernels.h"

#include "simd/tables.h"

namespace mane::contact {

MANE_DECLARE_TABLES(WispKernels, kWisps)

const WispKernels& WispKernelsFor(simd::Isa isa) {
  return simd::Tables<WispKernels> MANE_TABLES(kWisps).For(isa);
}

}  // namespace mane::contact
