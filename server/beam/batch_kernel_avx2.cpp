#define MANE_ISA avx2

#include "beam/batch_kernel_table.h"

namespace mane::beam::avx2 {

extern const KernelTable<float> kFloat = MakeTable<float, 8>();
extern const KernelTable<double> kDouble = MakeTable<double, 4>();

}  // namespace mane::beam::avx2
