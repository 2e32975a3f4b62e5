#define MANE_ISA scalar

#include "beam/batch_kernel_table.h"

namespace mane::beam::scalar {

extern const KernelTable<float> kFloat = MakeTable<float, 1>();
extern const KernelTable<double> kDouble = MakeTable<double, 1>();

}  // namespace mane::beam::scalar
