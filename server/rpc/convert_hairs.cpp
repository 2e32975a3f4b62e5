#include "rpc/convert_hairs.h"

#include <cstdint>
#include <numeric>
#include <string>
#include <vector>

#include "rpc/convert_values.h"

namespace mane::rpc {
namespace {

constexpr size_t kHairBytes = 9;  // Guide, count, colour.
constexpr size_t kBatchBytes = 512 << 10;

Result<void> CheckSize(const std::string& list, size_t entries, const char* what, size_t expected) {
  if (entries == expected) return {};
  return InvalidArgument(list, fmt::format("{} has {} entries; for {} {} it must have {}", list,
                                           entries, expected, what, expected));
}

}  // namespace

Result<void> AppendHairs(const v1::HairBatch& batch, groom::Hairs* hairs) {
  const size_t before = hairs->count();
  if (auto ok = AppendBytes(batch.guides(), "hairs.guides", &hairs->guides); !ok) return ok;
  std::vector<uint16_t> counts;
  if (auto ok = AppendBytes(batch.point_counts(), "hairs.point_counts", &counts); !ok) return ok;
  if (auto ok = CheckSize("hairs.point_counts", counts.size(), "hairs", hairs->count() - before);
      !ok) {
    return ok;
  }
  const size_t points = std::accumulate(counts.begin(), counts.end(), size_t{0});
  if (auto ok = CheckSize("hairs.places", batch.places().size() / sizeof(wire::HairPlace),
                          "control points", points);
      !ok) {
    return ok;
  }
  if (auto ok = AppendBytes(batch.places(), "hairs.places", &hairs->places); !ok) return ok;
  for (const uint16_t count : counts) {
    hairs->first_point.push_back(hairs->first_point.back() + count);
  }
  const bool coloured = !hairs->colours.empty() || !batch.colours().empty();
  if (auto ok = AppendBytes(batch.colours(), "hairs.colours", &hairs->colours); !ok || !coloured) {
    return ok;
  }
  return CheckSize("hairs.colours", hairs->colours.size(), "hairs of all batches until now",
                   hairs->count());
}

void FromHairs(const groom::Hairs& hairs, size_t begin, size_t end, v1::HairBatch* batch) {
  FromEntries(hairs.guides, begin, end - begin, batch->mutable_guides());
  std::vector<uint16_t> counts;
  counts.reserve(end - begin);
  for (size_t i = begin; i < end; ++i) {
    counts.push_back(static_cast<uint16_t>(hairs.first_point[i + 1] - hairs.first_point[i]));
  }
  FromEntries(counts, 0, counts.size(), batch->mutable_point_counts());
  FromEntries(hairs.places, hairs.first_point[begin],
              hairs.first_point[end] - hairs.first_point[begin], batch->mutable_places());
  FromEntries(hairs.colours, begin, end - begin, batch->mutable_colours());
}

size_t EndOfBatch(const groom::Hairs& hairs, size_t begin) {
  size_t end = begin, bytes = 0;
  while (end < hairs.count()) {
    bytes += kHairBytes + hairs.places_of(end).size_bytes();
    if (end > begin && bytes > kBatchBytes) break;
    ++end;
  }
  return end;
}

}  // namespace mane::rpc
