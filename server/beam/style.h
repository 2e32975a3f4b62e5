#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <functional>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "beam/hull.h"

namespace mane::beam {

/// Where hair grows, or which hair is meant, by polar coordinates of its pore on the hull. The ends
/// belong to it; from one to the other there is 1e-6 rad at least.
struct PoreRegion {
  double least_zenith = 0;                    ///< [rad], in [0, pi], below `greatest_zenith`.
  double greatest_zenith = std::numbers::pi;  ///< [rad]
  double from_azimuth = -std::numbers::pi;    ///< [rad], in [-pi, pi]. From here toward +X
  double to_azimuth = std::numbers::pi;       ///< to here; from > to goes through the nape.
};

/// The points with normal . x >= offset.
struct HalfSpace {
  Eigen::Vector3d normal = Eigen::Vector3d::UnitY();  ///< Any length but 0.
  double offset = 0;                                  ///< [m] for a unit normal.

  /// Above its plane; not below 0 where the half-space is [m for a unit normal].
  [[nodiscard]] double HeightOf(const Eigen::Vector3d& point) const {
    return normal.dot(point) - offset;
  }
};

/// What draws hair somewhere, besides gravity ([AUK92] 2.2): an acceleration that acts on segments
/// that begin in all half-spaces, of hair whose pore lies in the region.
struct Force {
  enum class Kind {
    kUniform,  ///< `vector` [m/s^2].
    kToward,  ///< Of size `strength` toward `point`, falling off linearly within `softening` of it.
    kAround,  ///< What of kToward lies along the hull's surface: combs hair without lifting it.
  };
  Kind kind = Kind::kUniform;
  Eigen::Vector3d vector = Eigen::Vector3d::Zero();
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  ///< Head frame [m].
  double strength = 0;                              ///< [m/s^2]
  double softening = 0.01;                          ///< [m]
  std::vector<HalfSpace> where;                     ///< Empty for everywhere; at most 8.
  PoreRegion pores;
};

/// What a pair of scissors does: a hair ends where it first leaves what the cut keeps, so that its
/// last segment may be shorter; what would end in less than a segment inside the hull ends a node
/// earlier, and a hair of no segment is left out. At least one of the three is given.
struct Cut {
  PoreRegion pores;              ///< Hair that it is about.
  std::optional<double> height;  ///< Cuts what is below this y [m].
  std::vector<HalfSpace> keep;   ///< Cuts what is outside of any, at most 8.
  /// Longest length left [m], by the height of the pore, linear between the two and constant beyond
  /// ([AUK92] Figure 6 (d)).
  struct ByPore {
    double low_y = 0, low_length = 0;
    double high_y = 0, high_length = 0;
  };
  std::optional<ByPore> by_pore;
};

/// Hair that is made alike: a hairstyle has one or several ([AUK92] makes a ponytail of its own).
struct Part {
  enum class Spread {
    kUniform,  ///< Pores at even distances.
    kRandom,   ///< Drawn evenly over the area.
  };
  std::string name;  ///< At most 64 bytes; errors and reports name it.
  PoreRegion pores;
  /// Hair grows from a disc about this point instead, of that radius, and sets out along
  /// `tied_along`: a ponytail behind its ribbon, a tuft.
  std::optional<Eigen::Vector3d> tied_at;  ///< Head frame [m], outside the hull.
  double tied_radius = 0.01;               ///< [m]
  Eigen::Vector3d tied_along = Eigen::Vector3d(0, 0, -1);
  Spread spread = Spread::kRandom;
  int count = 10'000;    ///< Hairs, 1 to 200,000 of all parts together.
  int segments = 20;     ///< k, 2 to 200.
  double length = 0.25;  ///< Uncut [m], in [1e-3, 5].
  double length_fluctuation =
      0;                   ///< Lengths are drawn within this part of it up and down, in [0, 0.9].
  double rigidity = 5e-9;  ///< EI [N m^2], in [1e-15, 1].
  double rigidity_fluctuation = 0;  ///< As of lengths.
  double line_density = 5e-6;       ///< rho [kg/m], in [1e-9, 1].
  std::vector<Force> forces;        ///< At most 16, besides gravity and those of the style.
  std::vector<Cut> cuts;            ///< At most 16; they follow those of the style.
};

/// A hairstyle by beams, whole. All parts have at most 10 million nodes before they are cut.
struct BeamStyle {
  uint64_t seed = 0;
  double gravity = 9.81;  ///< [m/s^2], in [0, 1000], along -Y.
  /// Standard deviation of the factor on k_a that each hair draws (B18), in [0, 1].
  double ambient_deviation = 0.2;
  std::vector<Part> parts;    ///< 1 to 16.
  std::vector<Force> forces;  ///< On all parts, at most 16.
  std::vector<Cut> cuts;      ///< Of all parts, at most 16.
};

/// Hairs as polylines in the head frame, what is cut left out.
struct StyledHairs {
  std::vector<uint32_t> part;          ///< Of each hair, not decreasing, (hairs).
  std::vector<uint32_t> first_node;    ///< Of each, and the total, (hairs + 1); at least 2 a hair.
  std::vector<Eigen::Vector3f> nodes;  ///< Pore first [m].
  std::vector<float> ambient;          ///< Factor on k_a of each hair (B18), (hairs).

  [[nodiscard]] int count() const { return static_cast<int>(first_node.size()) - 1; }
};

/// Runs `work` on pieces [first, last) of [0, count), at once or one after the other. Where the
/// outcome is not wanted any more it may leave pieces out; what comes of that is of no use.
using Loop = std::function<void(int count, const std::function<void(int first, int last)>& work)>;

/// INVALID_ARGUMENT naming a part of `field`, as mane.v1.BeamStyle has it, for what is out of range
/// whatever the head.
[[nodiscard]] Result<void> ValidateBeamStyle(const BeamStyle& style, const std::string& field);

/// Styles a head: pores, bending (B3 to B6), cuts. The same bits for the same arguments, whatever
/// `loop` does. Every node lies outside the hull or on it; segments have the length that they were
/// given to within the rounding of their nodes' coordinates to float, but for the last of cut hair.
///
/// @param style  valid (ValidateBeamStyle).
/// @return INVALID_ARGUMENT naming a part of `field` for what does not fit the head: tied points
///         inside it, cuts that meet no hair or leave none of a part (those of the style: none at
///         all).
[[nodiscard]] Result<StyledHairs> ApplyBeamStyle(const BeamStyle& style, const Hull& hull,
                                                 const std::string& field, const Loop& loop);

}  // namespace mane::beam
