#pragma once

#include <string>
#include <vector>

#include "beam/hull.h"
#include "beam/style.h"

namespace mane::beam {

/// A hairstyle to begin with.
struct BeamPreset {
  std::string name;
  std::string description;  ///< One sentence.
  BeamStyle style;          ///< For PresetHull.
};

/// The hull of a grown head about its frame's origin: (0.08, 0.11, 0.10) m, eyes at y = 0.
[[nodiscard]] Hull PresetHull();

/// Five styles after [AUK92] Figures 3 and 6, of some 20,000 hairs each: "bob", "drooping_bangs",
/// "swept_back", "ponytail", "short".
[[nodiscard]] std::vector<BeamPreset> BeamPresets();

}  // namespace mane::beam
