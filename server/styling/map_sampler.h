#pragma once

#include <optional>
#include <vector>

#include "groom/hair_region.h"
#include "math/random.h"
#include "math/weighted_choice.h"
#include "styling/chart.h"
#include "styling/map_bounds.h"
#include "styling/style.h"

namespace mane::styling {

/// Draws points of a scalp at random, by a map (scalp.md, P6): exactly, not on a grid.
///
/// The patches of the hair region are halved into cells where the map varies most within them,
/// until three of four proposals are taken, or there are 2^17 more cells. Cells on which the map
/// is 0 are left out.
///
/// Refers to what it is made of. Immutable; any thread may draw.
class MapSampler {
 public:
  enum class Measure {
    kValue,    ///< Points come in proportion to the map.
    kSupport,  ///< Points come evenly from where the map is above 0.
  };

  /// @param map  valid, nowhere below 0.
  MapSampler(const groom::HairRegion& region, const ScalpChart& chart, const ScalpMap& map,
             Measure measure);

  /// Whether the map is 0 everywhere, by its bounds.
  [[nodiscard]] bool empty() const { return cells_.empty(); }

  /// Integral of the measure over the scalp [m^2], over the part of proposals that are taken.
  [[nodiscard]] double proposed() const { return choice_.total(); }

  /// A random point, or none: then ask again. Its position is a float32 one. Not when empty().
  [[nodiscard]] std::optional<groom::ScalpPoint> Propose(math::RandomStream& random) const;

 private:
  // Part of a patch.
  struct Cell {
    int patch;
    double s0, s1, t0, t1;
    double area;
    Bounds bounds;

    // What is proposed in vain at most.
    [[nodiscard]] double waste() const { return area * (bounds.high - bounds.low); }
  };

  [[nodiscard]] Cell MakeCell(int patch, double s0, double s1, double t0, double t1,
                              const MapBounds& bounds) const;
  [[nodiscard]] std::pair<Cell, Cell> Halves(const Cell& cell, const MapBounds& bounds) const;
  void Refine(const MapBounds& bounds);

  const groom::HairRegion& region_;
  const ScalpChart& chart_;
  const ScalpMap& map_;
  Measure measure_;
  std::vector<Cell> cells_;
  math::WeightedChoice choice_;
};

}  // namespace mane::styling
