#include <fmt/format.h>

#include <numbers>
#include <optional>
#include <utility>

#include "beam/pores.h"
#include "beam/style.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr size_t kMostParts = 16;
constexpr size_t kMostForces = 16;
constexpr size_t kMostCuts = 16;
constexpr size_t kMostHalfSpaces = 8;
constexpr size_t kLongestName = 64;
constexpr int64_t kMostHairs = 200'000;
constexpr int64_t kMostNodes = 10'000'000;
constexpr double kFarthest = 100;      // Of a coordinate [m].
constexpr double kLargestForce = 1e4;  // [m/s^2]
constexpr double kNarrowest = 1e-6;    // Of a region [rad].
constexpr double kLongest = 5;         // [m]

// The first thing that is wrong below a field; later ones are not looked at.
class Checker {
 public:
  explicit Checker(std::string field) : field_(std::move(field)) {}

  // A checker of what lies below, which is done where something is wrong already.
  template <typename Work>
  void Below(const std::string& name, const Work& work) {
    if (error_) return;
    const size_t size = field_.size();
    field_ += field_.empty() || name.front() == '[' ? name : "." + name;
    work();
    field_.resize(size);
  }
  template <typename Item, typename Work>
  void Each(const char* name, const std::vector<Item>& items, size_t least, size_t most,
            const Work& work) {
    Number(name, static_cast<double>(items.size()), static_cast<double>(least),
           static_cast<double>(most), "entries");
    for (size_t i = 0; i < items.size(); ++i) {
      Below(fmt::format("{}[{}]", name, i), [&] { work(items[i]); });
    }
  }

  void Number(const char* name, double value, double least, double greatest, const char* unit) {
    if (value >= least && value <= greatest) return;
    const char* space = *unit == 0 ? "" : " ";
    Fail(name,
         fmt::format("is {}{}{}; it must be in [{}, {}]", value, space, unit, least, greatest));
  }
  void Vector(const char* name, const Vector3d& value, double greatest, const char* unit) {
    if (value.cwiseAbs().maxCoeff() <= greatest && value.allFinite()) return;
    Fail(name, fmt::format("is ({}, {}, {}) {}; its components must be in [{}, {}]", value.x(),
                           value.y(), value.z(), unit, -greatest, greatest));
  }
  // Of a length that a direction can be told from.
  void Direction(const char* name, const Vector3d& value) {
    Number(name, value.norm(), 1e-6, 1e6, "(its length)");
  }
  void Fail(const char* name, const std::string& message) {
    if (error_) return;
    Below(name, [&] { error_ = InvalidArgument(field_, fmt::format("{} {}", field_, message)); });
  }

  [[nodiscard]] Result<void> Outcome() const { return error_ ? *error_ : Result<void>(); }

 private:
  std::string field_;
  std::optional<Error> error_;
};

void Check(Checker* check, const PoreRegion& region) {
  check->Below("pores", [&] {
    check->Number("zenith.low", region.least_zenith, 0, pi, "rad");
    check->Number("zenith.high", region.greatest_zenith, 0, pi, "rad");
    check->Number("azimuth.low", region.from_azimuth, -pi, pi, "rad");
    check->Number("azimuth.high", region.to_azimuth, -pi, pi, "rad");
    if (!(region.greatest_zenith - region.least_zenith >= kNarrowest)) {
      check->Fail("zenith.low",
                  fmt::format("is {} rad; it must be below zenith.high, {} rad, by {} at least",
                              region.least_zenith, region.greatest_zenith, kNarrowest));
    }
    if (!(AzimuthsOf(region) >= kNarrowest)) {
      check->Fail("azimuth.low",
                  fmt::format("is {} rad; from it to azimuth.high, {} rad, must be {} at least",
                              region.from_azimuth, region.to_azimuth, kNarrowest));
    }
  });
}

void Check(Checker* check, const HalfSpace& half) {
  check->Direction("normal", half.normal);
  check->Number("offset_m", half.offset, -kFarthest * 1e6, kFarthest * 1e6, "m");
}

void Check(Checker* check, const char* name, const std::vector<HalfSpace>& halves) {
  check->Each(name, halves, 0, kMostHalfSpaces, [&](const HalfSpace& half) { Check(check, half); });
}

void Check(Checker* check, const std::vector<Force>& forces) {
  check->Each("forces", forces, 0, kMostForces, [&](const Force& force) {
    if (force.kind == Force::Kind::kUniform) {
      check->Vector("acceleration", force.vector, kLargestForce, "m/s^2");
    } else {
      check->Vector("point", force.point, kFarthest, "m");
      check->Number("strength_m_s2", force.strength, 0, kLargestForce, "m/s^2");
      check->Number("softening_m", force.softening, 1e-6, kFarthest, "m");
    }
    Check(check, "where", force.where);
    Check(check, force.pores);
  });
}

void Check(Checker* check, const Cut::ByPore& by_pore) {
  check->Below("by_pore", [&] {
    check->Number("low_y_m", by_pore.low_y, -kFarthest, kFarthest, "m");
    check->Number("high_y_m", by_pore.high_y, -kFarthest, kFarthest, "m");
    check->Number("low_length_m", by_pore.low_length, 0, kLongest, "m");
    check->Number("high_length_m", by_pore.high_length, 0, kLongest, "m");
    if (by_pore.low_y >= by_pore.high_y) {
      check->Fail("low_y_m", fmt::format("is {} m; it must be below high_y_m, {} m", by_pore.low_y,
                                         by_pore.high_y));
    }
  });
}

void Check(Checker* check, const std::vector<Cut>& cuts) {
  check->Each("cuts", cuts, 0, kMostCuts, [&](const Cut& cut) {
    Check(check, cut.pores);
    if (cut.height) check->Number("height_m", *cut.height, -kFarthest, kFarthest, "m");
    Check(check, "keep", cut.keep);
    if (cut.by_pore) Check(check, *cut.by_pore);
    if (!cut.height && cut.keep.empty() && !cut.by_pore) {
      check->Fail("height_m", "is unset; a cut needs height_m, keep or by_pore");
    }
  });
}

void Check(Checker* check, const Part& part) {
  check->Number("name", static_cast<double>(part.name.size()), 0, kLongestName, "bytes");
  Check(check, part.pores);
  check->Number("tied_radius_m", part.tied_radius, 0, 1, "m");
  if (part.tied_at) {
    check->Vector("tied_at", *part.tied_at, kFarthest, "m");
    check->Direction("tied_along", part.tied_along);
  }
  check->Number("hair_count", part.count, 1, static_cast<double>(kMostHairs), "");
  check->Number("segment_count", part.segments, 2, 200, "");
  check->Number("length_m", part.length, 1e-3, kLongest, "m");
  check->Number("length_fluctuation", part.length_fluctuation, 0, 0.9, "");
  check->Number("rigidity_n_m2", part.rigidity, 1e-15, 1, "N m^2");
  check->Number("rigidity_fluctuation", part.rigidity_fluctuation, 0, 0.9, "");
  check->Number("line_density_kg_m", part.line_density, 1e-9, 1, "kg/m");
  Check(check, part.forces);
  Check(check, part.cuts);
}

}  // namespace

Result<void> ValidateBeamStyle(const BeamStyle& style, const std::string& field) {
  Checker check(field);
  check.Number("gravity_m_s2", style.gravity, 0, 1000, "m/s^2");
  check.Number("ambient_deviation", style.ambient_deviation, 0, 1, "");
  int64_t hairs = 0, nodes = 0;
  check.Each("parts", style.parts, 1, kMostParts, [&](const Part& part) {
    Check(&check, part);
    hairs += part.count;
    nodes += int64_t{part.count} * (part.segments + 1);
  });
  check.Number("parts", static_cast<double>(hairs), 1, static_cast<double>(kMostHairs),
               "hairs together");
  check.Number("parts", static_cast<double>(nodes), 1, static_cast<double>(kMostNodes),
               "nodes together");
  Check(&check, style.forces);
  Check(&check, style.cuts);
  return check.Outcome();
}

}  // namespace mane::beam
