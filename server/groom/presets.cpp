#include "groom/presets.h"

#include <numbers>

#include "base/check.h"

namespace mane::groom {
namespace {

constexpr double kDensity = 1300;  // kg/m^3, [SH06] 4.2.

rod::Section Ellipse(double mean_radius, double ellipticity) {
  const double minor = 2 * mean_radius / (1 + ellipticity);
  return {ellipticity * minor, minor};
}

}  // namespace

Preset PresetOf(HairType type) {
  switch (type) {
    case HairType::kAsianSmooth:
      return {Ellipse(50e-6, 1.0), {1.0e9, 0.48, kDensity}, 0, 0, 5e-11, 5e-6};
    case HairType::kCaucasianWavy:
      return {Ellipse(35e-6, 1.1), {2.0e9, 0.48, kDensity}, 0.010, 0.005, 7e-11, 1e-5};
    case HairType::kCaucasianCurly:
      return {Ellipse(50e-6, 1.1), {1.5e9, 0.48, kDensity}, 0.006, 0.005, 1e-10, 2e-5};
    case HairType::kAfricanFuzzy:
      return {Ellipse(50e-6, 1.2), {0.5e9, 0.48, kDensity}, 0.001, 0.010, 5e-10, 5e-5};
    case HairType::kCustom:
      break;
  }
  MANE_CHECK(type != HairType::kCustom);
  return {};
}

Eigen::Vector3d NaturalCurvature(const Preset& preset) {
  const double r = preset.helix_radius;
  if (r == 0) return Eigen::Vector3d::Zero();
  return {preset.helix_step / (2 * std::numbers::pi * r * r), 1 / r, 0};
}

}  // namespace mane::groom
