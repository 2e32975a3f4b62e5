#include "rpc/hair_upload.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "rpc/convert_hairs.h"

namespace mane::rpc {
namespace {

constexpr size_t kMaxGuides = std::numeric_limits<int>::max();

}  // namespace

Result<void> HairUpload::Add(const v1::HairBatch& batch) {
  if (auto ok = AppendHairs(batch, &hairs_); !ok) return ok;
  return groom::CheckHairCounts(hairs_.count(), hairs_.places.size(), limits_);
}

Result<std::shared_ptr<const groom::Hairs>> HairUpload::Take(double offset_unit,
                                                             size_t guide_count) {
  if (hairs_.count() == 0) return std::shared_ptr<const groom::Hairs>();
  hairs_.offset_unit = offset_unit;
  const int guides = static_cast<int>(std::min(guide_count, kMaxGuides));
  if (auto ok = groom::ValidateHairs(hairs_, guides, limits_); !ok) return ok.error();
  return std::make_shared<const groom::Hairs>(std::move(hairs_));
}

}  // namespace mane::rpc
