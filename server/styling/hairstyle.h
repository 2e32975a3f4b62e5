#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "groom/sampler.h"

namespace mane::styling {

/// Where hair grows ([CK05] 2.3).
struct Roots {
  std::vector<groom::ScalpPoint> masters;  ///< (wisps)
  std::vector<uint32_t> first_member;      ///< Of each wisp, and the total at the end, (wisps + 1).
  std::vector<Eigen::Vector3f> members;    ///< In the order of their wisps [m], (strands).

  [[nodiscard]] int wisps() const { return static_cast<int>(masters.size()); }
  [[nodiscard]] int strands() const { return static_cast<int>(members.size()); }
};

/// Master strands. Joint i of a strand holds its control point i, at arc length i * segment_length
/// of the outline; joint 0 is the root.
///
/// Masters reach somewhat beyond their own length, as far as their longest member may need
/// (`reach`): `length` is that of the strand itself.
struct Masters {
  double segment_length = 0.01;
  std::vector<uint32_t> first_joint;     ///< Of each master, and the total, (wisps + 1).
  std::vector<float> length;             ///< Of the outline [m], (wisps).
  std::vector<Eigen::Vector3f> details;  ///< delta_i, in the frame of joint i [m], (joints).
  std::vector<Eigen::Vector3f> outline;  ///< c_i, head frame [m], (joints).
  /// Of joint i: takes its details to the head frame; its x axis lies along the segment that leaves
  /// the joint (of the last joint, along the one that ends there), (joints).
  std::vector<Eigen::Quaternionf> frames;
  std::vector<Eigen::Vector3f> points;  ///< p_i = c_i + frame_i delta_i [m], (joints).

  [[nodiscard]] int wisps() const { return static_cast<int>(length.size()); }
  [[nodiscard]] int joints() const { return static_cast<int>(details.size()); }
};

/// Member strands: polylines of control points, of which a Catmull-Rom spline goes through all.
struct Members {
  std::vector<uint32_t> first_point;    ///< Of each strand, and the total, (strands + 1).
  std::vector<Eigen::Vector3f> points;  ///< Root first [m].

  [[nodiscard]] int strands() const { return static_cast<int>(first_point.size()) - 1; }
  [[nodiscard]] std::span<const Eigen::Vector3f> strand(int i) const {
    return std::span(points).subspan(first_point[i], first_point[i + 1] - first_point[i]);
  }
};

/// Hue (turns), saturation, value, each in [0, 1].
using Hsv = std::array<float, 3>;

}  // namespace mane::styling
