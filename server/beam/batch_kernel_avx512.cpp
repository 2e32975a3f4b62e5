#define MANE_ISA avx512

#include "beam/batch_kernel_table.h"

namespace mane::beam::avx512 {

extern const KernelTable<float> kFloat = MakeTable<float, 16>();
extern const KernelTable<double> kDouble = MakeTable<double, 8>();

}  // namespace mane::beam::avx512
