#include "head/sample_groom.h"

#include <cmath>
#include <numbers>
#include <utility>

#include "groom/assemble.h"
#include "groom/generate.h"
#include "groom/validate.h"

namespace mane::head {

std::shared_ptr<const groom::Groom> SampleGroom(int guides, int elements, SampleHair hair) {
  groom::Parts parts;
  for (int i = 0; i < guides; ++i) {
    const double angle = 2 * std::numbers::pi * i / guides;
    groom::GuideDescription description;
    description.root_position = {0.08 * std::cos(angle), 0.05, 0.08 * std::sin(angle)};
    description.root_frame = Eigen::Quaterniond::FromTwoVectors(
        Eigen::Vector3d::UnitX(), description.root_position.normalized());
    description.length_m = 0.1 + 0.2 * i / guides;
    description.element_count = static_cast<uint32_t>(elements);
    description.radius_1_m = 4e-5;
    description.radius_2_m = 3.5e-5;
    description.young_modulus_pa = 2e9;
    description.poisson_ratio = 0.48;
    description.density_kg_m3 = 1300;
    description.internal_friction = 1e-10;
    description.air_drag = 5e-6;
    description.natural_curvature_1 = {i % 2 == 0 ? 0.0 : 60.0};
    description.natural_twist = {i % 2 == 0 ? 0.0 : 15.0};
    if (hair == SampleHair::kWound || (hair == SampleHair::kMixed && i % 4 == 3)) {
      description.natural_curvature_1 = {600};
      description.natural_twist = {500};
      description.model = groom::StrandModel::kWound;
    }
    parts.guides.push_back(*groom::MakeGuide(description, i));
  }
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

std::shared_ptr<const groom::Groom> GeneratedGroom(groom::HairType type, int guides, double length,
                                                   int elements) {
  groom::Generation generation;
  generation.hair_type = type;
  generation.guide_count = static_cast<uint32_t>(guides);
  generation.length_m = length;
  generation.element_count = static_cast<uint32_t>(elements);
  generation.seed = 3;
  groom::Parts parts;
  parts.scalp = groom::Ellipsoid{{0, 0.1, 0.02}, {0.078, 0.11, 0.098}, {0, 1, -0.3}, 1.4};
  parts.guides = *groom::Generate(parts.scalp, generation, {});
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

}  // namespace mane::head
