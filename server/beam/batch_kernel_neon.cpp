#define MANE_ISA neon

#include "beam/batch_kernel_table.h"

namespace mane::beam::neon {

extern const KernelTable<float> kFloat = MakeTable<float, 4>();
extern const KernelTable<double> kDouble = MakeTable<double, 2>();

}  // namespace mane::beam::neon
