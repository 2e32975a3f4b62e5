#define MANE_ISA avx512

#include "rod/batch_kernel_table.h"

namespace mane::rod::avx512 {

extern const KernelTable<float> kFloat = MakeTable<float, 16>();
extern const KernelTable<double> kDouble = MakeTable<double, 8>();

}  // namespace mane::rod::avx512
