#include "rpc/beam_presets.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "beam/presets.h"
#include "rpc/convert_beam_style.h"

namespace mane::rpc {
namespace {

using Eigen::Vector3d;

// Of Mane's mannequin (groom::ScalpHull), rounded.
const beam::Hull kHead{{0, 0.055, 0.025}, {0.092, 0.113, 0.117}};

// To what people like to read in a document.
double Rounded(double value) { return std::round(1e4 * value) / 1e4; }

Vector3d Rounded(const Vector3d& v) {
  return v.unaryExpr([](double x) { return Rounded(x); });
}

// Moves a style from one hull to another, with places stretched as the hull is. Accelerations and
// lengths stay.
class Mover {
 public:
  Mover(const beam::Hull& from, const beam::Hull& to)
      : scale_(to.radii.cwiseQuotient(from.radii)), shift_(to.center - Scaled(from.center)) {}

  void Move(beam::BeamStyle* style) const {
    MoveForcesAndCuts(style);
    for (beam::Part& part : style->parts) {
      Tidy(&part.pores);
      if (part.tied_at) part.tied_at = At(*part.tied_at);
      MoveForcesAndCuts(&part);
    }
  }

 private:
  [[nodiscard]] Vector3d Scaled(const Vector3d& v) const { return scale_.cwiseProduct(v); }
  [[nodiscard]] Vector3d At(const Vector3d& point) const {
    return Rounded(Vector3d(Scaled(point) + shift_));
  }
  [[nodiscard]] double AtHeight(double y) const { return Rounded(scale_.y() * y + shift_.y()); }

  static void Tidy(beam::PoreRegion* region) {
    for (double* angle : {&region->least_zenith, &region->greatest_zenith, &region->from_azimuth,
                          &region->to_azimuth}) {
      *angle = Tidied(*angle);
    }
  }
  // Half a turn stays what it is, or it would be more.
  static double Tidied(double angle) {
    return std::abs(angle) == std::numbers::pi ? angle : Rounded(angle);
  }

  // n . x >= o of the points that x' = S x + t are: S^-1 n . x' >= o + S^-1 n . t, n of length 1.
  void MovePlanes(std::vector<beam::HalfSpace>* half_spaces) const {
    for (beam::HalfSpace& half_space : *half_spaces) {
      const Vector3d normal = half_space.normal.cwiseQuotient(scale_);
      const double length = normal.norm();
      half_space.normal = Rounded(Vector3d(normal / length));
      half_space.offset = Rounded((half_space.offset + normal.dot(shift_)) / length);
    }
  }

  template <typename StyleOrPart>
  void MoveForcesAndCuts(StyleOrPart* whole) const {
    for (beam::Force& force : whole->forces) {
      Tidy(&force.pores);
      if (force.kind != beam::Force::Kind::kUniform) force.point = At(force.point);
      MovePlanes(&force.where);
    }
    for (beam::Cut& cut : whole->cuts) {
      Tidy(&cut.pores);
      if (cut.height) cut.height = AtHeight(*cut.height);
      MovePlanes(&cut.keep);
      if (!cut.by_pore) continue;
      cut.by_pore->low_y = AtHeight(cut.by_pore->low_y);
      cut.by_pore->high_y = AtHeight(cut.by_pore->high_y);
    }
  }

  Vector3d scale_, shift_;
};

}  // namespace

void AddBeamPresets(v1::ListStylePresetsResponse* response) {
  const Mover mover(beam::PresetHull(), kHead);
  for (beam::BeamPreset& preset : beam::BeamPresets()) {
    mover.Move(&preset.style);
    v1::StylePreset* message = response->add_presets();
    std::ranges::replace(preset.name, '_', '-');
    message->set_name("beam-" + preset.name);
    message->set_description(preset.description);
    *message->mutable_beam_style() = FromBeamStyle({std::move(preset.style)});
  }
}

}  // namespace mane::rpc
