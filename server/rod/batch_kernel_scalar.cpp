#define MANE_ISA scalar

#include "rod/batch_kernel_table.h"

namespace mane::rod::scalar {

extern const KernelTable<float> kFloat = MakeTable<float, 1>();
extern const KernelTable<double> kDouble = MakeTable<double, 1>();

}  // namespace mane::rod::scalar
