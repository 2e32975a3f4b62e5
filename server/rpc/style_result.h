#pragma once

#include "base/result.h"
#include "jobs/job_context.h"
#include "mane/v1/style.pb.h"
#include "styling/beam_hairstyle.h"
#include "styling/stylist.h"

namespace mane::rpc {

/// How a style came out; what guides took, and the groom's name, are left open.
[[nodiscard]] v1::StyleReport MakeReport(const styling::Style& style,
                                         const styling::Hairstyle& hairstyle,
                                         const styling::StageTimes& times);

/// Adds masters, members, density, field and maps to the result of a job: serialised
/// v1::HairstylePart of some hundred kilobytes, one a chunk. Errors as JobContext::AppendResult.
[[nodiscard]] Result<void> WriteHairstyle(const styling::Style& style,
                                          const styling::Hairstyle& hairstyle,
                                          jobs::JobContext& context);

/// The same of hair by beams: masters, which are its guides, and members.
[[nodiscard]] Result<void> WriteBeams(const styling::BeamHairstyle& hairstyle,
                                      jobs::JobContext& context);

}  // namespace mane::rpc
