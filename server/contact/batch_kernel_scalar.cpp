#define MANE_ISA scalar

#include "contact/meeting_kernel.h"
#include "contact/wisp_kernel.h"

namespace mane::contact::scalar {

extern const MeetingKernels kMeetings = MeetingTable<1>::Make();
extern const WispKernels kWisps = WispTable<1>::Make();

}  // namespace mane::contact::scalar
