#define MANE_ISA neon

#include "contact/meeting_kernel.h"
#include "contact/wisp_kernel.h"

namespace mane::contact::neon {

extern const MeetingKernels kMeetings = MeetingTable<4>::Make();
extern const WispKernels kWisps = WispTable<4>::Make();

}  // namespace mane::contact::neon
