#define MANE_ISA avx2

#include "rod/batch_kernel_table.h"

namespace mane::rod::avx2 {

extern const KernelTable<float> kFloat = MakeTable<float, 8>();
extern const KernelTable<double> kDouble = MakeTable<double, 4>();

}  // namespace mane::rod::avx2
