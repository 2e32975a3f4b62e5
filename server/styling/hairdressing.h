#pragma once

#include <Eigen/Core>

#include <string>
#include <variant>
#include <vector>

#include "styling/style.h"

namespace mane::styling {

/// What a hairdresser does to a part of the hair ([CK05] 6.2). Each is worked into a style as the
/// paper says: cutting edits lengths, a permanent wave is another prototype, combing a direction
/// constraint, tying a point constraint of weight 1, braiding a point and then a trajectory for
/// each of several groups of wisps.
struct Operation {
  struct Trim {
    std::optional<double> length;            ///< Longest that is left [m].
    std::optional<Region::HalfSpace> plane;  ///< Cut::plane
  };
  struct Wave {
    Synthesis synthesis;
  };
  struct Comb {
    std::vector<Eigen::Vector3d> path;  ///< Head frame [m], 2 or more.
    double radius = 0.03;               ///< Of influence [m].
    double weight = 0.8;
  };
  struct Tie {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    double radius = 0.015;  ///< Of the ribbon [m].
  };
  struct Braid {
    std::vector<Eigen::Vector3d> path;  ///< Its axis [m], 2 or more; hair is gathered at the first
                                        ///< and tied at the last.
    int strand_count = 3;               ///< 2 to 9.
    double radius = 0.02;               ///< Half its width [m].
    double period = 0.1;  ///< Along the axis, until each strand is back in its place [m].
  };

  std::string source;  ///< Its path, which errors name: `header.style.operations[1]`.
  Region region;
  std::variant<Trim, Wave, Comb, Tie, Braid> what;
};

/// Works `operation` into `style`. Operations that lead hair of equal regions one after the other
/// share a queue, in their order; a braid ends what may be done to its hair.
void Dress(const Operation& operation, Style* style);

/// The axis of strand `strand` of a braid: about `axis`, at most `radius` to either side and half
/// that to the front and back, in step with the others. With phi = 2 pi (t / period + strand / n),
///
///     offset = radius (sin(phi) side + sin(2 phi) / 2 front)
///
/// a figure of eight, in which each strand crosses its neighbours once over and once under a
/// period.
///
/// @param axis  polyline [m], 2 points or more, neighbours apart.
/// @return a polyline with 16 points a period at least.
[[nodiscard]] std::vector<Eigen::Vector3d> BraidStrand(const std::vector<Eigen::Vector3d>& axis,
                                                       int strand, int strand_count, double radius,
                                                       double period);

}  // namespace mane::styling
