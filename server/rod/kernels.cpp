#include "rod/kernels.h"

#include "simd/tables.h"

namespace mane::rod {

MANE_DECLARE_TABLES(KernelTable<float>, kFloat)
MANE_DECLARE_TABLES(KernelTable<double>, kDouble)

template <>
const KernelTable<float>& KernelsFor<float>(simd::Isa isa) {
  return simd::Tables<KernelTable<float>> MANE_TABLES(kFloat).For(isa);
}

template <>
const KernelTable<double>& KernelsFor<double>(simd::Isa isa) {
  return simd::Tables<KernelTable<double>> MANE_TABLES(kDouble).For(isa);
}

}  // namespace mane::rod
