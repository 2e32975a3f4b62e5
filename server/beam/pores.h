#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <vector>

#include "beam/hull.h"
#include "beam/style.h"

namespace mane::beam {

/// How many azimuths a region takes [rad].
[[nodiscard]] double AzimuthsOf(const PoreRegion& region);

[[nodiscard]] bool Contains(const PoreRegion& region, const Polar& pore);

/// Where a hair begins.
struct Pore {
  Eigen::Vector3d root;       ///< Head frame [m].
  Eigen::Vector3d direction;  ///< Unit; along the hull's outward normal, or along the tie.
  Polar polar;                ///< Of the root (PolarOf).
};

/// The pores of a part (beam.md, Pores): any of them is found without the others.
class Pores {
 public:
  /// @param hull   on which pores lie.
  /// @param part   valid (ValidateBeamStyle).
  /// @param index  of the part in its style; with the seed and the hair it names what is drawn.
  Pores(const Hull& hull, const Part& part, uint64_t seed, int index);

  /// @param hair  in [0, count).
  [[nodiscard]] Pore At(int hair) const;

 private:
  [[nodiscard]] Pore Tied(int hair) const;
  [[nodiscard]] Polar Random(int hair) const;
  [[nodiscard]] Polar Even(int hair) const;
  void LayRows();

  Hull hull_;
  Part part_;
  uint64_t seed_;
  int index_;
  double azimuths_ = 0;             // Of the region [rad].
  std::vector<double> row_zenith_;  // Even: of each row,
  std::vector<int> row_first_;      // its first hair, and the total.
  std::vector<double> arc_;         // Along the equator [m], up to equal steps of azimuth.
};

/// What the numbers of a stream are for: each hair has one stream for each purpose.
enum class Purpose { kPore, kHair };

/// The stream of one hair's numbers.
[[nodiscard]] uint64_t StreamOf(int part, int hair, Purpose purpose);

}  // namespace mane::beam
