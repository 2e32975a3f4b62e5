#pragma once

#include "beam/kernels.h"
#include "simd/test_every_isa.h"

namespace mane::beam::fixtures {

template <typename T>
using EveryIsaTest = simd::fixtures::EveryIsaTest<&KernelsFor<T>>;
using simd::fixtures::Numbers;

}  // namespace mane::beam::fixtures
