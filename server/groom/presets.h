#pragma once

#include <Eigen/Core>

#include "groom/groom.h"

namespace mane::groom {

/// What a hair type says about a strand of any length: [SH06] Appendix B, section 4.2 for the rest.
struct Preset {
  /// Major semi-axis along n1. (EI)_1 = E pi/4 a b^3 is then the softer bending, and the natural
  /// curvature, which is about n1, lies in that plane, where follicles of oval section curl hair.
  rod::Section section;
  rod::Material material;
  double helix_radius = 0;       ///< r_h [m]; 0 for straight hair.
  double helix_step = 0;         ///< Delta_h [m]
  double internal_friction = 0;  ///< gamma [kg m^3/s]
  double air_drag = 0;           ///< nu [kg/(m s)]
};

/// Numbers of a hair type other than kCustom.
///
/// Appendix B gives the mean radius r, taken as (a + b)/2, and the ellipticity e = a/b. It does not
/// give friction; section 4.2 gives the ranges, gamma in [5e-11, 5e-10] and nu in [5e-6, 5e-5], and
/// Mane places the types in them by these remarks: gamma is 1e-10 for the curly clump of figure 6,
/// and friction between strands grows with the complexity of their shape (2.2), so smooth hair
/// takes the low end and fuzzy hair the high one; nu is lowest for disciplined hair and highest for
/// fuzzy hair, and wavy and curly hair stand at even ratios between.
[[nodiscard]] Preset PresetOf(HairType type);

/// Natural (twist, curvature 1, curvature 2) [rad/m] of a preset by [SH06] 4.2:
/// (Delta_h / (2 pi r_h^2), 1 / r_h, 0), and zero for straight hair.
///
/// These are the helix formulas for a step much smaller than 2 pi r_h. African hair has a longer
/// one (1 cm against 0.63 cm), so that its rod winds tighter than the measured helix: radius 0.28
/// mm and step 2.8 mm. The values are kept as published.
[[nodiscard]] Eigen::Vector3d NaturalCurvature(const Preset& preset);

}  // namespace mane::groom
