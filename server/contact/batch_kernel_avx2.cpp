#define MANE_ISA avx2

#include "contact/meeting_kernel.h"

namespace mane::contact::avx2 {

extern const MeetingKernels kMeetings = MeetingTable<8>::Make();

}  // namespace mane::contact::avx2
