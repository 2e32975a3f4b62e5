#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <optional>
#include <span>
#include <vector>

namespace mane::styling {

/// A curve as outline and details ([CK05] 2.2.1): p_i = c_i + F_i delta_i, (W2).
struct Decomposition {
  double structure = 0;  ///< Outline length of the longest regular structure [m]; 0 without one.
  /// c_i: at equal distances from each other, exactly, (points).
  std::vector<Eigen::Vector3d> outline;
  /// F_i: x axis along the segment that leaves the joint (the last: along the one that ends there),
  /// turned along with the least rotation, (points).
  std::vector<Eigen::Quaterniond> frames;
  std::vector<Eigen::Vector3d> details;  ///< delta_i [m], (points).

  [[nodiscard]] int points() const { return static_cast<int>(outline.size()); }
};

/// Arc length [m] after which a curve repeats its shape, 0 where it has none: the lag of the
/// highest peak of its tangents' autocorrelation (W4). Seen up to 0.6 of the curve, so that it must
/// come nearly twice. Without a clear peak, a curve that turns to and fro at random many times has
/// four times the lag where the correlation is lost, (W5). An arc, an S, a straight line have none.
///
/// @param curve  points at equal arc length, such as Resample makes; at least 16.
[[nodiscard]] double FindStructure(std::span<const Eigen::Vector3d> curve);

/// Cuts a curve into outline and details. The outline runs along the curve's axis: its moving
/// average over one structure, straight on over half a structure at both ends, (W3). A curve
/// without structure is its own axis, and its details are exactly 0.
///
/// What remains of the axis beyond the last whole segment is left out.
///
/// @param curve           polyline, two points or more, finite, of positive length; any spacing.
/// @param segment_length  > 0 [m]. A curve shorter than it makes one point.
/// @param structure       its arc length along the curve [m]; nothing to find it; 0 for none. More
///                        than the curve's length counts as none.
/// Cost: some milliseconds, bounded whatever the curve, and linear in its points.
[[nodiscard]] Decomposition Decompose(std::span<const Eigen::Vector3d> curve, double segment_length,
                                      std::optional<double> structure = {});

}  // namespace mane::styling
