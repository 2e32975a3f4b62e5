#define MANE_ISA neon

#include "rod/batch_kernel_table.h"

namespace mane::rod::neon {

extern const KernelTable<float> kFloat = MakeTable<float, 4>();
extern const KernelTable<double> kDouble = MakeTable<double, 2>();

}  // namespace mane::rod::neon
