#include "contact/meeting_kernels.h"

#include "simd/tables.h"

namespace mane::contact {

MANE_DECLARE_TABLES(MeetingKernels, kMeetings)

const MeetingKernels& MeetingKernelsFor(simd::Isa isa) {
  return simd::Tables<MeetingKernels> MANE_TABLES(kMeetings).For(isa);
}

}  // namespace mane::contact
