#define MANE_ISA avx512

#include "contact/meeting_kernel.h"
#include "contact/wisp_kernel.h"

namespace mane::contact::avx512 {

extern const MeetingKernels kMeetings = MeetingTable<16>::Make();
extern const WispKernels kWisps = WispTable<16>::Make();

}  // namespace mane::contact::avx512
