#define MANE_ISA avx2

#include "contact/meeting_kernel.h"
#include "contact/wisp_kernel.h"

namespace mane::contact::avx2 {

extern const MeetingKernels kMeetings = MeetingTable<8>::Make();
extern const WispKernels kWisps = WispTable<8>::Make();

}  // namespace mane::contact::avx2
