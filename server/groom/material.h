#pragma once

#include "groom/body.h"

namespace mane::groom {

/// What a surface is made of: mane.v1.Material.
enum class Material : int { kUnspecified, kSkin, kCotton, kWool, kSilk, kLeather, kPolished };

/// How hair rubs on it.
///
/// No one measured all of these in one way, so that they are choices, set beside what was measured.
/// Straight hair rubbed towards its root by a probe had 0.47, wavy hair 0.54 (Konno, Asanuma,
/// Nonomura, J. Oleo Sci. 73(5), 2024): towards the tip, against the scales, it is more than
/// across. The table has 0.5 so for skin, 0.4 (1 + 0.25), to which hair sticks somewhat. Surfaces
/// order as they feel: wool's own scales catch, silk and polish glide. Anisotropy needs something
/// that the scales catch at: against smooth fibres sound hair has none (Langmuir 29(19), 2013,
/// doi 10.1021/la400468f), so that it falls with smoothness.
[[nodiscard]] Friction FrictionOf(Material material);

}  // namespace mane::groom
