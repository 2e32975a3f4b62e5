#include "beam/kernels.h"

#include "base/check.h"

namespace mane::beam {

#define MANE_DECLARE_TABLES(isa)            \
  namespace isa {                           \
  extern const KernelTable<float> kFloat;   \
  extern const KernelTable<double> kDouble; \
  }

MANE_DECLARE_TABLES(scalar)
MANE_DECLARE_TABLES(neon)
MANE_DECLARE_TABLES(avx2)
MANE_DECLARE_TABLES(avx512)

namespace {

// What was compiled for this architecture.
struct Tables {
  const KernelTable<float>* float_table;
  const KernelTable<double>* double_table;
};

Tables TablesFor(simd::Isa isa) {
  switch (isa) {
    case simd::Isa::kScalar:
      return {&scalar::kFloat, &scalar::kDouble};
#if defined(__aarch64__)
    case simd::Isa::kNeon:
      return {&neon::kFloat, &neon::kDouble};
#elif defined(__x86_64__)
    case simd::Isa::kAvx2:
      return {&avx2::kFloat, &avx2::kDouble};
    case simd::Isa::kAvx512:
      return {&avx512::kFloat, &avx512::kDouble};
#endif
    default:
      return {nullptr, nullptr};
  }
}

}  // namespace

template <>
const KernelTable<float>& KernelsFor<float>(simd::Isa isa) {
  const KernelTable<float>* table = TablesFor(isa).float_table;
  MANE_CHECK(table != nullptr);
  return *table;
}

template <>
const KernelTable<double>& KernelsFor<double>(simd::Isa isa) {
  const KernelTable<double>* table = TablesFor(isa).double_table;
  MANE_CHECK(table != nullptr);
  return *table;
}

}  // namespace mane::beam
