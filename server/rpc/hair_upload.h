#pragma once

#include <memory>

#include "base/result.h"
#include "groom/hairs.h"
#include "groom/limits.h"
#include "mane/v1/groom.pb.h"

namespace mane::rpc {

/// The hairs of one CreateGroom call, gathered as they come.
class HairUpload {
 public:
  explicit HairUpload(const groom::Limits& limits) : limits_(limits) {}

  /// Takes the next hairs. kInvalidArgument where the batch's lists do not fit each other,
  /// kResourceExhausted above the limits.
  Result<void> Add(const v1::HairBatch& batch);

  /// All of them, once nothing is added any more, checked by groom::ValidateHairs; null for none.
  ///
  /// @param offset_unit  as the header says [m]. @param guide_count  of the groom.
  Result<std::shared_ptr<const groom::Hairs>> Take(double offset_unit, size_t guide_count);

 private:
  const groom::Limits limits_;
  groom::Hairs hairs_;
};

}  // namespace mane::rpc
