#pragma once

#include "base/check.h"
#include "simd/isa.h"

namespace mane::simd {

/// A folder's kernels, one table for each instruction set; null where the architecture has not that
/// set. Filled by MANE_TABLES.
template <typename Table>
struct Tables {
  const Table* scalar;
  const Table* neon;
  const Table* avx2;
  const Table* avx512;

  /// The table for a set that Supported() lists.
  [[nodiscard]] const Table& For(Isa isa) const {
    const Table* const all[] = {scalar, neon, avx2, avx512};  // In the order of Isa.
    const Table* const table = all[static_cast<int>(isa)];
    MANE_CHECK(table != nullptr);
    return *table;
  }
};

}  // namespace mane::simd

/// Declares a table of every instruction set, each in its namespace within the current one.
#define MANE_DECLARE_TABLES(Table, name) \
  namespace scalar {                     \
  extern const Table name;               \
  }                                      \
  namespace neon {                       \
  extern const Table name;               \
  }                                      \
  namespace avx2 {                       \
  extern const Table name;               \
  }                                      \
  namespace avx512 {                     \
  extern const Table name;               \
  }

/// Those that were compiled for this architecture.
#if defined(__aarch64__)
#define MANE_TABLES(name) \
  { &scalar::name, &neon::name, nullptr, nullptr }
#elif defined(__x86_64__)
#define MANE_TABLES(name) \
  { &scalar::name, nullptr, &avx2::name, &avx512::name }
#else
#define MANE_TABLES(name) \
  { &scalar::name, nullptr, nullptr, nullptr }
#endif
