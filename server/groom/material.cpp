#include "groom/material.h"

namespace mane::groom {

Friction FrictionOf(Material material) {
  switch (material) {
    case Material::kUnspecified:
      return {};
    case Material::kSkin:
      return {0.4, 0.25};
    case Material::kCotton:
      return {0.35, 0.3};
    case Material::kWool:
      return {0.5, 0.4};
    case Material::kSilk:
      return {0.2, 0.1};
    case Material::kLeather:
      return {0.4, 0.2};
    case Material::kPolished:
      return {0.15, 0.05};
  }
  return {};
}

}  // namespace mane::groom
