#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "base/result.h"
#include "mane/v1/style.pb.h"
#include "styling/style.h"

namespace mane::rpc {

/// Parts of style.proto to the domain, at the path `field`, which errors name. What only the
/// encoding can get wrong, and how much there may be of something, is checked; ranges are not.

/// kInvalidArgument where a repeated field has more than `most` entries.
[[nodiscard]] Result<void> CheckCount(const std::string& field, long count, long most);

/// Each of a repeated field, as `convert` makes it of a message and its path.
template <typename Message, typename Convert>
auto ToList(const Message& messages, const std::string& field, int most, const Convert& convert)
    -> Result<std::vector<std::decay_t<decltype(*convert(*messages.begin(), std::string()))>>> {
  std::vector<std::decay_t<decltype(*convert(*messages.begin(), std::string()))>> list;
  if (const auto ok = CheckCount(field, messages.size(), most); !ok) return ok.error();
  for (int i = 0; i < messages.size(); ++i) {
    auto entry = convert(messages[i], fmt::format("{}[{}]", field, i));
    if (!entry) return entry.error();
    list.push_back(*std::move(entry));
  }
  return list;
}

/// Decodes the PNG files of one style: a few bytes can hold millions of pixels, so all together may
/// have as many as two of the largest, and files that are equal are decoded once.
class ImageReader {
 public:
  /// Null for an empty file. INVALID_ARGUMENT naming `field`; RESOURCE_EXHAUSTED above the pixels.
  [[nodiscard]] Result<std::shared_ptr<const styling::MapImage>> Read(const std::string& png,
                                                                      const std::string& field);

 private:
  static constexpr int64_t kMaxPixels = int64_t{2} << 24;
  int64_t pixels_ = 0;
  std::map<std::string, std::shared_ptr<const styling::MapImage>> read_;  // By their bytes.
};

/// @param unset  its value where it says none.
[[nodiscard]] Result<styling::ScalpMap> ToMap(const v1::ScalpMap& message, double unset,
                                              const std::string& field, ImageReader* images);
[[nodiscard]] Result<styling::Region::HalfSpace> ToHalfSpace(
    const v1::ScalpRegion::HalfSpace& message, const std::string& field);
[[nodiscard]] Result<styling::Region> ToRegion(const v1::ScalpRegion& message,
                                               const std::string& field, ImageReader* images);
/// @param unset  where no form is set.
[[nodiscard]] Result<styling::Distribution> ToDistribution(const v1::Distribution& message,
                                                           const styling::Distribution& unset,
                                                           const std::string& field);
[[nodiscard]] Result<styling::Synthesis> ToSynthesis(const v1::Synthesis& message,
                                                     const std::string& field);

}  // namespace mane::rpc
