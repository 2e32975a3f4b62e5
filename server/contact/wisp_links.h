#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstdint>
#include <vector>

#include "contact/segment_grid.h"
#include "contact/wisp_layout.h"
#include "contact/wisp_points.h"

namespace mane::contact {

/// What a head's wisps may cost in a step: so much a point, and as much as for some thousands of
/// points `more`, so that small heads are searched in full (contact.md, H3).
[[nodiscard]] inline double Budget(double a_point, double more, const WispPoints& points) {
  return a_point * (more + points.size());
}

/// The step in which wisps are searched.
struct WispStep {
  float dt;       ///< [s]
  float h;        ///< kTheta dt: positions are extrapolated by it [s].
  float relaxed;  ///< Part of the way that distances go in it to those of the rest shape (H5).
  bool first;     ///< Nothing was tracked before it: what meets keeps the distance it has (H5).
  const WispKernels* kernels;
};

/// A rigid frame that goes with a head's hair: links are seen in it, so that hair which is carried
/// along and turned rests. Any frame is right; the better it goes with the hair, the less is
/// searched.
struct WispFrame {
  Eigen::Matrix3f to_frame;  ///< From axes of the points.
  Eigen::Vector3f position;  ///< At the start of the step [m].
  Eigen::Vector3f velocity;  ///< [m/s]
  Eigen::Vector3f spin;      ///< [rad/s]

  /// How some of the hair moves, in the least squares by mass; turned as `turn` is, which is
  /// brought on to the next step.
  [[nodiscard]] static WispFrame Fit(const WispPoints& points, const WispStep& step,
                                     Eigen::Quaternionf* turn);
};

/// Stretches of guides, and which of them may meet in the steps to come (contact.md, H3).
struct WispNeighbours {
  static constexpr int8_t kNone = -128;

  /// Of links; the first's guide is before the second's.
  struct Pair {
    int32_t first, second;
    float slack;        ///< They need not be looked at until they have moved by this [m].
    int8_t segment[2];  ///< Which come near, counted from each one's first; kNone where none do.

    [[nodiscard]] bool known() const { return segment[0] != kNone; }
  };
  /// How a guide is cut into links.
  struct Layout {
    int32_t link;    ///< Segments of a link, but for the last; the root's do not count.
    bool unsettled;  ///< Some points could not be used: it is laid out anew.
  };
  /// What a link's neighbours were last searched for, in the frame.
  struct Around {
    float bulge = 0;     ///< How far its points were from the line between its ends [m],
    float half = 0;      ///< half of its longest segment,
    float reach = 0;     ///< its reach,
    int32_t count = 0;   ///< its segments' number,
    int32_t point = -1;  ///< its first point,
    float spare = -1;    ///< what a point may move until a new search [m]; < 0: has none;
    float widest = 1;    ///< and what it may be in the next search at most [m].
  };
  std::vector<int32_t> first;       ///< WispPoints::first that all is for,
  std::vector<float> radius;        ///< and its radius.
  std::vector<Layout> layout;       ///< By guide.
  std::vector<int32_t> first_link;  ///< By guide, and their number.
  Eigen::Quaternionf turn =
      Eigen::Quaternionf::Identity();     ///< From the frame to the points' axes.
  float longest_sweep = 0;                ///< Of a point that counts in a step [m].
  double tests = 0;                       ///< That a link's search took last, about,
  size_t next = 0;                        ///< and the link that comes first in the next one.
  std::vector<Around> around;             ///< By link.
  std::vector<Eigen::Vector3f> searched;  ///< Of its points, when it was last searched for [m];
                                          ///< what it shares with the next link counts twice.
  std::vector<Eigen::Vector3f> place;     ///< Of points at the start of the step; in the frame [m].
  std::vector<Pair> pairs;                ///< By first, then second.
  std::vector<int32_t> first_of;          ///< By guide of the first, and their number.
};

/// How a link moves, in the frame: its ends as a mean (3), and how much farther a point of it may
/// besides (1).
struct LinkMotion {
  Eigen::Vector4f moved;  ///< Since the last step [m],
  Eigen::Vector4f sweep;  ///< and in this one.
  float reach;            ///< WispLink::reach.
};

/// How much points of two links may have moved, or will, relative to each other at most [m].
[[nodiscard]] inline float Apart(const Eigen::Vector4f& a, const Eigen::Vector4f& b) {
  const Eigen::Vector4f d = a - b;
  return std::sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]) + a[3] + b[3];
}

/// A link of segments in a step; all in the frame.
struct WispLink {
  float bulge;     ///< How far a point of it is from the line between its ends at most [m],
  float ripple;    ///< and what it will move beside what the line does there.
  float half;      ///< Of its longest segment [m].
  float reach;     ///< Its wisp's radius and margin [m]; 0: it takes no part.
  float farthest;  ///< What a point has moved since the last search and will [m].
  int32_t guide;
  int32_t first;  ///< Point of it as a whole,
  int32_t point;  ///< and of what of it lies beyond the root,
  int32_t count;  ///< and the number of segments there.
};

}  // namespace mane::contact
