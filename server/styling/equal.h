#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "styling/style.h"

/// Whether two parts of styles say the same, images and grids by their content: what tells whether
/// a stage must be made again.
namespace mane::styling {

namespace equal {

template <typename T>
bool Contents(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b) {
  return a == b || (a && b && *a == *b);
}

}  // namespace equal

inline bool operator==(const MapImage& a, const MapImage& b) {
  return a.width == b.width && a.height == b.height && a.values == b.values;
}
inline bool operator==(const Stop& a, const Stop& b) { return a.at == b.at && a.value == b.value; }
inline bool operator==(const ScalpMap& a, const ScalpMap& b) {
  return a.value == b.value && a.by_polar == b.by_polar && a.by_azimuth == b.by_azimuth &&
         equal::Contents(a.image, b.image);
}
inline bool operator==(const Region::Interval& a, const Region::Interval& b) {
  return a.low == b.low && a.high == b.high;
}
inline bool operator==(const Region::HalfSpace& a, const Region::HalfSpace& b) {
  return a.normal == b.normal && a.offset == b.offset;
}
inline bool operator==(const Region& a, const Region& b) {
  return a.polar == b.polar && a.azimuth == b.azimuth && a.half_spaces == b.half_spaces &&
         equal::Contents(a.mask, b.mask) && a.wisps == b.wisps;
}
inline bool operator==(const Distribution& a, const Distribution& b) {
  return a.form == b.form && a.mean == b.mean && a.deviation == b.deviation && a.low == b.low &&
         a.high == b.high && a.densities == b.densities;
}
inline bool operator==(const Prototype& a, const Prototype& b) {
  return a.kind == b.kind && a.amplitude_m == b.amplitude_m && a.period_m == b.period_m &&
         a.points == b.points;
}
inline bool operator==(const Synthesis& a, const Synthesis& b) {
  return a.prototype == b.prototype && a.window == b.window && a.temperature == b.temperature;
}
inline bool operator==(const Style::RegionalSynthesis& a, const Style::RegionalSynthesis& b) {
  return a.region == b.region && a.synthesis == b.synthesis;
}
inline bool operator==(const FieldTerm::Grid& a, const FieldTerm::Grid& b) {
  return a.low == b.low && a.cell == b.cell && a.nodes == b.nodes && a.values == b.values;
}
inline bool operator==(const FieldTerm& a, const FieldTerm& b) {
  return a.kind == b.kind && a.strength == b.strength && a.direction == b.direction &&
         a.center == b.center && a.radius == b.radius && equal::Contents(a.grid, b.grid);
}
inline bool operator==(const Constraint& a, const Constraint& b) {
  return a.kind == b.kind && a.path == b.path && a.radius == b.radius && a.weight == b.weight;
}
inline bool operator==(const ConstraintQueue& a, const ConstraintQueue& b) {
  return a.selection == b.selection && a.share == b.share && a.share_count == b.share_count &&
         a.constraints == b.constraints;
}
inline bool operator==(const Cut& a, const Cut& b) {
  return a.region == b.region && a.length == b.length && a.plane == b.plane;
}
inline bool operator==(const Colouring& a, const Colouring& b) {
  return a.hue == b.hue && a.saturation == b.saturation && a.value == b.value &&
         a.wisp_share == b.wisp_share;
}

}  // namespace mane::styling
