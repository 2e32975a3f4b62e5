#include "beam/presets.h"

#include <numbers>
#include <utility>

namespace mane::beam {
namespace {

using Eigen::Vector3d;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kEyes = 0;      // y [m]
constexpr double kNeck = -0.1;   // y [m]
constexpr double kComb = 25;     // [m/s^2]
constexpr double kBeside = 0.3;  // From the middle of the head [m].

// By angles in degrees.
PoreRegion Region(double least_zenith, double greatest_zenith, double from, double to) {
  return {least_zenith * kDegree, greatest_zenith * kDegree, from * kDegree, to * kDegree};
}

Part PartOf(std::string name, const PoreRegion& pores, int count, double length) {
  Part part;
  part.name = std::move(name);
  part.pores = pores;
  part.count = count;
  part.length = length;
  part.rigidity_fluctuation = 0.3;
  return part;
}

Force Around(const Vector3d& point, double strength) {
  Force force;
  force.kind = Force::Kind::kAround;
  force.point = point;
  force.strength = strength;
  return force;
}

// The same for segments above a height alone.
Force AroundAbove(double y, const Vector3d& point, double strength) {
  Force force = Around(point, strength);
  force.where = {{Vector3d::UnitY(), y}};
  return force;
}

Cut Below(double y, const PoreRegion& pores = {}) {
  Cut cut;
  cut.pores = pores;
  cut.height = y;
  return cut;
}

// A force to one side all over: its point is far away.
Force Toward(const Vector3d& direction, double strength) {
  return Around(10 * direction, strength);
}

// Hair of either side of the head is combed to its side above the eyes, less and less farther down,
// so that it parts in the middle and falls without an edge; the hair of the face's side begins
// higher than that of the neck's.
std::vector<Part> Sides(double length, double length_fluctuation) {
  std::vector<Part> parts = {
      PartOf("right front", Region(0, 62, 0, 75), 4000, length),
      PartOf("left front", Region(0, 62, -75, 0), 4000, length),
      PartOf("right back", Region(0, 105, 75, 180), 5000, length),
      PartOf("left back", Region(0, 105, -180, -75), 5000, length),
  };
  for (size_t i = 0; i < parts.size(); ++i) {
    const Vector3d beside(i % 2 == 0 ? kBeside : -kBeside, 0, 0);
    for (const double y : {kEyes, kEyes + 0.02, kEyes + 0.04, kEyes + 0.06}) {
      parts[i].forces.emplace_back(AroundAbove(y, beside, kComb / 4));
    }
    parts[i].length_fluctuation = length_fluctuation;
  }
  return parts;
}

BeamPreset Bob() {
  BeamPreset bob{"bob", "Parted in the middle, short bangs, cut level at the neck.", {}};
  bob.style.parts = Sides(0.3, 0);
  for (Part& part : bob.style.parts) part.cuts = {Below(kNeck)};
  Part bangs = PartOf("bangs", Region(25, 62, -55, 55), 3500, 0.13);
  bangs.forces = {Toward({0, -0.5, 1}, kComb / 2)};
  bangs.cuts = {Below(0.005)};
  bangs.rigidity = 3e-9;
  bob.style.parts.emplace_back(bangs);
  return bob;
}

BeamPreset DroopingBangs() {
  BeamPreset out{"drooping_bangs", "A bob of uneven ends, whose bangs droop to the eyes.", {}};
  out.style.parts = Sides(0.25, 0.25);
  Part bangs = PartOf("bangs", Region(28, 62, -50, 50), 3500, 0.13);
  bangs.length_fluctuation = 0.3;
  bangs.rigidity = 4e-9;
  bangs.forces = {Toward({0.35, -0.3, 1}, kComb / 2)};
  out.style.parts.emplace_back(bangs);
  return out;
}

BeamPreset SweptBack() {
  BeamPreset out{"swept_back", "From the face backwards, with a tuft before either temple.", {}};
  Part all = PartOf("swept", Region(0, 62, -75, 75), 9000, 0.25);
  Part back = PartOf("back", Region(0, 105, 75, -75), 11'000, 0.22);
  // Behind the ears all of it falls.
  for (const double z : {-0.06, -0.04, -0.02, 0.0}) {
    Force combed = Toward({0, 0, -1}, kComb / 2);
    combed.where = {{Vector3d::UnitZ(), z}};
    all.forces.emplace_back(combed);
    back.forces.emplace_back(combed);
  }
  back.length_fluctuation = all.length_fluctuation = 0.1;
  out.style.parts = {all, back};
  for (const double side : {1.0, -1.0}) {
    const double from = side > 0 ? 62 : -74, to = side > 0 ? 74 : -62;
    Part tuft = PartOf(side > 0 ? "right tuft" : "left tuft", Region(64, 76, from, to), 400, 0.1);
    tuft.rigidity = 2e-10;
    out.style.parts.emplace_back(tuft);
  }
  return out;
}

// Of the hull, on the way to its center.
Vector3d PointUnder(const Vector3d& point) {
  const Polar polar = PolarOf(PresetHull(), point);
  return PresetHull().Point(polar.zenith, polar.azimuth);
}

BeamPreset Ponytail() {
  BeamPreset out{"ponytail", "Drawn to the back of the head and tied there.", {}};
  const Vector3d tie(0, 0.05, -0.094);
  Part front = PartOf("front", Region(0, 62, -75, 75), 6000, 0.26);
  Part back = PartOf("back", Region(0, 118, 75, -75), 9000, 0.22);
  // Ends where it reaches the ribbon: at a plane that cuts a cap from the hull there.
  const Vector3d under = PointUnder(tie), outward = PresetHull().Gradient(under).normalized();
  Cut ribbon;
  ribbon.keep = {{-outward, 0.002 - outward.dot(under)}};
  for (Part* drawn : {&front, &back}) {
    drawn->forces = {Around(tie, 120)};
    drawn->rigidity = 1e-9;
    drawn->cuts = {ribbon};
  }
  Part tail = PartOf("tail", {}, 6000, 0.35);
  tail.tied_at = tie;
  tail.tied_radius = 0.012;
  tail.tied_along = {0, 0.3, -1};
  tail.length_fluctuation = 0.15;
  tail.rigidity = 6e-8;
  tail.rigidity_fluctuation = 0.5;
  out.style.parts = {front, back, tail};
  return out;
}

BeamPreset ShortCut() {
  BeamPreset out{"short", "Short at the neck, longer toward the crown.", {}};
  out.style.parts = {PartOf("front", Region(0, 62, -75, 75), 8000, 0.12),
                     PartOf("back", Region(0, 110, 75, -75), 12'000, 0.12)};
  for (Part& part : out.style.parts) part.rigidity = 2e-9;
  out.style.parts[0].forces = {Toward({0, -0.5, 1}, kComb / 2)};
  out.style.parts[1].forces = {Toward({0, -1, -0.5}, kComb)};
  Cut by_pore;
  by_pore.by_pore = Cut::ByPore{-0.04, 0.015, 0.11, 0.11};
  out.style.cuts = {by_pore, Below(0.02, Region(0, 62, -75, 75))};
  return out;
}

}  // namespace

Hull PresetHull() { return {Vector3d::Zero(), Vector3d(0.08, 0.11, 0.1)}; }

std::vector<BeamPreset> BeamPresets() {
  return {Bob(), DroopingBangs(), SweptBack(), Ponytail(), ShortCut()};
}

}  // namespace mane::beam
