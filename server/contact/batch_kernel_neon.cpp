#define MANE_ISA neon

#include "contact/meeting_kernel.h"

namespace mane::contact::neon {

extern const MeetingKernels kMeetings = MeetingTable<4>::Make();

}  // namespace mane::contact::neon
