#include "styling/colour.h"

#include <algorithm>
#include <cmath>

#include "math/random.h"
#include "styling/distribution.h"

namespace mane::styling {
namespace {

constexpr uint64_t kWispSalt = 0x434f4c4f55525f57;    // Of the streams of wisps,
constexpr uint64_t kStrandSalt = 0x434f4c4f55525f53;  // and of strands.
constexpr int kGrain = 16;                            // Wisps a piece.

std::array<double, 3> Normals(uint64_t seed, int stream) {
  math::RandomStream random(seed, static_cast<uint64_t>(stream));
  const double x = random.Normal(), y = random.Normal();
  return {x, y, random.Normal()};
}

}  // namespace

std::vector<Hsv> Colour(const Roots& roots, const Colouring& colouring, uint64_t seed,
                        exec::WorkerPool& pool) {
  const std::array<Quantile, 3> quantiles{Quantile(colouring.hue), Quantile(colouring.saturation),
                                          Quantile(colouring.value)};
  const double of_wisp = std::sqrt(colouring.wisp_share);
  const double of_strand = std::sqrt(1 - colouring.wisp_share);
  std::vector<Hsv> colours(roots.strands());
  pool.ParallelFor(roots.wisps(), kGrain, [&](int begin, int end) {
    for (int wisp = begin; wisp < end; ++wisp) {
      const auto shared = Normals(seed ^ kWispSalt, wisp);
      for (uint32_t i = roots.first_member[wisp]; i < roots.first_member[wisp + 1]; ++i) {
        const auto own = Normals(seed ^ kStrandSalt, static_cast<int>(i));
        for (int c = 0; c < 3; ++c) {  // (W21)
          colours[i][c] =
              static_cast<float>(quantiles[c](NormalCdf(of_wisp * shared[c] + of_strand * own[c])));
        }
        const float hue = colours[i][0] - std::floor(colours[i][0]);
        colours[i][0] = hue < 1 ? hue : 0;  // Just below a whole turn rounds to 1.
      }
    }
  });
  return colours;
}

std::array<float, 3> HsvToRgb(const Hsv& hsv) {
  const auto [hue, saturation, value] = hsv;
  std::array<float, 3> rgb;
  for (int c = 0; c < 3; ++c) {
    // Distance of the channel's own hue, 0 to 3 sixths of a turn: full up to 1, nothing from 2 on.
    const float turns = hue - static_cast<float>(c) / 3;
    const float sixths = 6 * std::abs(turns - std::round(turns));
    rgb[c] = value * (1 - saturation * std::clamp(sixths - 1, 0.0F, 1.0F));
  }
  return rgb;
}

std::array<uint8_t, 3> HsvToRgb8(const Hsv& hsv) {
  std::array<uint8_t, 3> rgb{};
  const std::array<float, 3> colour = HsvToRgb(hsv);
  for (int i = 0; i < 3; ++i) {
    rgb[i] = static_cast<uint8_t>(std::lround(255 * std::clamp(colour[i], 0.0F, 1.0F)));
  }
  return rgb;
}

}  // namespace mane::styling
