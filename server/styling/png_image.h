#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "base/result.h"
#include "styling/style.h"

namespace mane::styling {

/// Reads a PNG image as a map: any bit depth, grey, palette or colours, interlaced or not.
///
/// A value is the stored sample over its greatest, 8 and 16 bit alike: maps are numbers, so gamma
/// and colour profiles are passed over. Of colours it is the luma 0.2126 R + 0.7152 G + 0.0722 B;
/// what is transparent is laid over black.
///
/// @param field  names the image in errors.
/// @return INVALID_ARGUMENT where `png` is no whole PNG image of 1 to 4096 pixels a side. Sizes are
///         checked before memory is taken for them; then it is that of the result and of a row.
[[nodiscard]] Result<MapImage> DecodePng(std::span<const std::byte> png, const std::string& field);

/// Pixels that the header of a PNG image says, 0 where it has none: what DecodePng would take
/// memory for.
[[nodiscard]] int64_t PixelsOf(std::span<const std::byte> png);

/// `image`, which is valid, as a grey PNG of 16 bits: values come back within 1 / 131070. The same
/// image makes the same bytes.
[[nodiscard]] std::string EncodePng(const MapImage& image);

}  // namespace mane::styling
