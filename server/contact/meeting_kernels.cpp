#include "contact/meeting_kernels.h"

#include "base/check.h"

namespace mane::contact {

namespace scalar {
extern const MeetingKernels kMeetings;
}
namespace neon {
extern const MeetingKernels kMeetings;
}
namespace avx2 {
extern const MeetingKernels kMeetings;
}
namespace avx512 {
extern const MeetingKernels kMeetings;
}

const MeetingKernels& MeetingKernelsFor(simd::Isa isa) {
  const MeetingKernels* kernels = nullptr;
  switch (isa) {
    case simd::Isa::kScalar:
      kernels = &scalar::kMeetings;
      break;
#if defined(__aarch64__)
    case simd::Isa::kNeon:
      kernels = &neon::kMeetings;
      break;
#elif defined(__x86_64__)
    case simd::Isa::kAvx2:
      kernels = &avx2::kMeetings;
      break;
    case simd::Isa::kAvx512:
      kernels = &avx512::kMeetings;
      break;
#endif
    default:
      break;
  }
  MANE_CHECK(kernels != nullptr);
  return *kernels;
}

}  // namespace mane::contact
