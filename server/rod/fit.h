#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "math/rigid.h"

namespace mane::rod {

/// How a polyline is to become a strand.
struct FitOptions {
  int elements = 10;  ///< N, or the most that may be used where `bound` is given; >= 1.
  /// Largest distance allowed [m]. Where given, the fewest elements that keep within it are sought,
  /// by doubling and halving, from `fewest` on: one fewer was tried and missed it.
  double bound = std::numeric_limits<double>::infinity();
  int fewest = 1;  ///< Elements that a search for `bound` begins with, in [1, elements].
  /// Element lengths up to a common factor, (elements), positive; empty: equal lengths. Not with a
  /// bound.
  std::vector<double> proportions = {};
  /// Rotation of the root frame, columns n0, n1, n2; where absent the tangent is fitted, and n1 is
  /// across the tangent and the world axis least along it.
  std::optional<Eigen::Quaterniond> root = std::nullopt;
  /// Standard deviation of the points' coordinates [m]; 0: exact; negative: estimate it. It sets
  /// how closely twist and jumps of curvature may follow the points.
  double noise = -1;
};

/// A piecewise helix near a polyline.
struct Fit {
  math::Pose root;                     ///< Root frame; the origin is the first point.
  std::vector<double> length;          ///< Element lengths [m], (N).
  std::vector<Eigen::Vector3d> theta;  ///< Element angles, twist first [rad], (N).
  /// Distances of the points from the points of the centreline that match them in order, and of the
  /// last one from the tip [m].
  double largest_distance = 0;
  double rms_distance = 0;
  bool bound_met = false;      ///< largest_distance <= bound.
  double smoothed_length = 0;  ///< Of the spline that the fit started from [m].
  double noise = 0;            ///< Given or estimated [m].
  int iterations = 0;
};

/// Fits a strand to `points` [m], root first (rod.md, Fit, F1 to F6). The strand's length is that
/// of the fitted centreline itself, from the first point to the match of the last; it is an unknown
/// of the fit within a few tenths of a percent of the smoothing spline's length, up to three
/// percent where the points are coarse.
///
/// Any finite points give a finite answer: neighbours closer than 1e-9 of the whole are one point;
/// two points, or points on a line, give a straight strand without twist; points that all coincide
/// give a straight one of 1e-6 m along the root's axis. O(N^3 + n) an iteration.
///
/// @param points  (n >= 1), finite, below 1e100 (checked by the caller).
[[nodiscard]] Fit FitPolyline(std::span<const Eigen::Vector3d> points,
                              const FitOptions& options = {});

}  // namespace mane::rod
