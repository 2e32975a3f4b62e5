#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "exec/worker_pool.h"
#include "styling/hairstyle.h"
#include "styling/style.h"

namespace mane::styling {

/// A colour for every strand ([CK05] 5): each channel of its own distribution, which all strands
/// together have whatever the wisp share, (W21). Hue is brought into [0, 1), saturation and value
/// are as drawn. A function of its arguments, for any number of workers.
///
/// @param colouring  valid; wisp_share in [0, 1] is the correlation of two strands of a wisp (of
///                   the normal numbers behind the channel).
[[nodiscard]] std::vector<Hsv> Colour(const Roots& roots, const Colouring& colouring, uint64_t seed,
                                      exec::WorkerPool& pool);

/// Red, green, blue in [0, 1]. Hue has period 1.
[[nodiscard]] std::array<float, 3> HsvToRgb(const Hsv& hsv);
/// The same in 8 bits a channel, rounded.
[[nodiscard]] std::array<uint8_t, 3> HsvToRgb8(const Hsv& hsv);

}  // namespace mane::styling
