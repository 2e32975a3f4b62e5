#pragma once

#include <span>

#include "base/result.h"
#include "groom/import.h"
#include "mane/v1/groom.pb.h"

namespace mane::rpc {

/// Messages of an import to the domain and back. Ranges are checked by the groom folder; what only
/// the encoding can get wrong, here.

/// Unset fields become their defaults. kInvalidArgument for a hair type that is no preset.
Result<groom::ImportOptions> ToImportOptions(const v1::ImportOptions& message);

/// kInvalidArgument naming `strands[<index>].points` for bytes that are no whole number of points.
Result<groom::ImportedStrand> ToImportedStrand(const v1::ImportedStrand& message, int index);

/// The report on `outcomes`, summed up.
///
/// @param options  as they were applied.
void FromImport(const groom::ImportOptions& options, std::span<const groom::StrandOutcome> outcomes,
                v1::ImportReport* message);

}  // namespace mane::rpc
