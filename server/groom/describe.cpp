#include "groom/describe.h"

namespace mane::groom {

void SetProperties(const Preset& preset, GuideDescription* description) {
  description->radius_1_m = preset.section.radius_1;
  description->radius_2_m = preset.section.radius_2;
  description->young_modulus_pa = preset.material.young_modulus;
  description->poisson_ratio = preset.material.poisson_ratio;
  description->density_kg_m3 = preset.material.density;
  description->internal_friction = preset.internal_friction;
  description->air_drag = preset.air_drag;
}

void SetNatural(std::span<const Eigen::Vector3d> natural, GuideDescription* description) {
  std::vector<double>* components[] = {&description->natural_twist,
                                       &description->natural_curvature_1,
                                       &description->natural_curvature_2};
  for (int k = 0; k < 3; ++k) {
    components[k]->clear();
    for (const Eigen::Vector3d& n : natural) components[k]->push_back(n[k]);
  }
}

}  // namespace mane::groom
