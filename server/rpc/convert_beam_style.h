#pragma once

#include <string>

#include "base/result.h"
#include "beam/style.h"
#include "mane/v1/beam_style.pb.h"

namespace mane::rpc {

/// A beam style's document.
struct BeamDocument {
  beam::BeamStyle style;
  int guide_count = 300;  ///< Hairs that become guides, 1 to 20,000.
};

/// A document to the domain: what is unset gets its default. What only the encoding can get wrong,
/// and how much there may be of something, is checked here; ranges by beam::ValidateBeamStyle,
/// which is called at the end.
///
/// @param field  path of the message, such as `header.beam_style`. @return kInvalidArgument naming
///   the first field that is wrong.
[[nodiscard]] Result<BeamDocument> ToBeamStyle(const v1::BeamStyle& message,
                                               const std::string& field);

/// The inverse: ToBeamStyle of the result is `document`. What has its default stays unset.
[[nodiscard]] v1::BeamStyle FromBeamStyle(const BeamDocument& document);

}  // namespace mane::rpc
