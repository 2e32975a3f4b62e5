#define MANE_ISA scalar

#include "contact/meeting_kernel.h"

namespace mane::contact::scalar {

extern const MeetingKernels kMeetings = MeetingTable<1>::Make();

}  // namespace mane::contact::scalar
