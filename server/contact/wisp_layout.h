#pragma once

/// How segments of guides lie in memory for the kernels that find where wisps touch: rows of
/// simd::kLanes float32 numbers, one lane a pair of segments. Includes nothing: kernels may share
/// no function with other sources. H-numbers are those of contact.md.
namespace mane::contact {

inline constexpr int kLongestLink = 8;  ///< [segments]

/// Rows of two segments, or of the lines between the ends of two links.
enum SegmentPair : int {
  kEnds = 0,      ///< Of the first, then of the second, at the start of the step [m] (4 x 3).
  kMotion = 12,   ///< Of those ends: velocity [m/s], or way within the step [m] (4 x 3).
  kTouchAt = 24,  ///< Distance at which they touch [m].
  kSegmentPairRows = 25  ///< Rows in all.
};

/// Rows of where two segments come closest within a step (H2).
enum ApproachRows : int {
  kFractions = 0,                ///< Of each segment (2).
  kLeastApart = kFractions + 2,  ///< Their least distance within the step [m].
  kApart,                        ///< From the second to the first at the start [m] (3),
  kTouching = kApart + 3,        ///< and when they first touch or are closest [m] (3).
  kApproachRows = kTouching + 3  ///< Rows in all.
};

/// Rows of how two lines are to each other.
enum LineRows : int {
  kLinesApart = 0,  ///< Their least distance at the start [m],
  kLinesNearing,    ///< by how much no points of them come nearer within the step [m].
  kLineRows         ///< Rows in all.
};

/// The points of a link, three coordinates each, in the frame.
struct LinkPoints {
  const float* place;  ///< At the start of the step [m] (3 x (count + 1)).
  const float* sweep;  ///< What they will move in it [m] (3 x (count + 1)).
  int count;           ///< Of segments, 1 to kLongestLink.
  float half;          ///< Half of the longest [m].
};

/// The segments of two links that are nearest.
struct NearestSegments {
  float distance;  ///< [m]
  int segment[2];  ///< Counted from each link's first.
};

/// The kernels of one instruction set; pure functions of their arguments, each lane's result
/// depends on nothing in others.
struct WispKernels {
  /// Where segments come closest within `dt` [s], of rows of one kind to those of the other.
  void (*approach)(const float* segment_pairs, float dt, float* approaches);
  void (*lines)(const float* line_pairs, float* lines);
  /// The segments of two links that are nearest at the start of the step.
  NearestSegments (*closest)(const LinkPoints& a, const LinkPoints& b);
  /// Those whose middles come nearest within the step, and how near those do.
  NearestSegments (*closest_within)(const LinkPoints& a, const LinkPoints& b);
};

}  // namespace mane::contact
