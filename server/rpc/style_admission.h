#pragma once

#include <string>

#include "base/result.h"
#include "groom/import.h"
#include "groom/limits.h"
#include "mane/v1/style.pb.h"
#include "rpc/convert_beam_style.h"
#include "styling/style.h"

namespace mane::rpc {

/// How masters become guides: header.guides. kInvalidArgument names `header.guides.` and the field.
[[nodiscard]] Result<groom::ImportOptions> ToGuideOptions(const v1::ApplyStyleHeader& header);

/// RESOURCE_EXHAUSTED where a style makes more guides, hairs or work than a groom may.
[[nodiscard]] Result<void> AdmitStyle(const styling::Style& style,
                                      const groom::ImportOptions& guides,
                                      const groom::Limits& limits);
[[nodiscard]] Result<void> AdmitBeamStyle(const BeamDocument& style,
                                          const groom::ImportOptions& guides,
                                          const groom::Limits& limits);

/// The same once the strands that become guides are known.
///
/// @param field  that says how many there are.
[[nodiscard]] Result<void> AdmitGuides(const std::vector<groom::ImportedStrand>& strands,
                                       const groom::ImportOptions& guides,
                                       const groom::Limits& limits, const std::string& field);

}  // namespace mane::rpc
