#pragma once

#include <Eigen/Core>

#include <string>
#include <vector>

#include "base/result.h"
#include "styling/style.h"

namespace mane::styling {

/// Most control points of a prototype: what a strand's synthesis costs grows with them.
inline constexpr int kMostDetails = 512;

/// The details of a prototype strand at a style's spacing ([CK05] 2.2).
struct Pattern {
  std::vector<Eigen::Vector3f> details;  ///< delta*_i, root first [m], 1 to kMostDetails.
  int structure = 0;  ///< Control points of the longest regular structure; 0 without one.
};

/// Dimensions of a shipped prototype [m].
struct StrandSize {
  double amplitude = 0;  ///< Largest offset from the axis, about: radius of curls.
  double period = 0;     ///< Length of a turn along the axis.
};

/// Own dimensions of a shipped prototype; 0 both for a straight one.
[[nodiscard]] StrandSize SizeOf(StrandKind kind);

/// A shipped prototype (not kStraight): `periods` turns along +x, 64 points each, with a natural
/// irregularity that depends on the kind only, (W8).
[[nodiscard]] std::vector<Eigen::Vector3d> ShippedStrand(StrandKind kind, const StrandSize& size,
                                                         int periods);

/// The prototype's details at `segment_length` [m] along its outline.
///
/// They are the same all along the strand: that a strand starts in its root is up to who uses
/// them (synthesis.h).
///
/// @param field  path of the prototype, for errors.
/// @return INVALID_ARGUMENT naming `<field>.points`, `<field>.points[3].x`, `<field>.amplitude_m`
///   or `<field>.period_m`: points that are fewer than four or more than 4096, not finite, in one
///   place; a prototype of more than kMostDetails segments, or less than one; a pattern of fewer
///   than four control points a period, with the segment length that it takes.
[[nodiscard]] Result<Pattern> PrototypeDetails(const Prototype& prototype, double segment_length,
                                               const std::string& field);

}  // namespace mane::styling
