#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "mane/error.h"
#include "mane/geometry.h"

namespace mane::inline client {

/// Where a control point of a hair is on its guide. 8 bytes, as it travels.
struct HairPlace {
  std::uint16_t part = 0;       ///< Of the guide's arc length: 65535 is the tip.
  std::int16_t offset[3] = {};  ///< In the carried frame, in units of Hairs::offset_unit_m.
};

/// Hairs that ride on a groom's guides: what is drawn, where guides are what moves.
///
/// A hair is a Catmull-Rom spline through its control points. Each is at a part of its guide's arc
/// length, moved by an offset along the guide and across it, in the guide's root frame carried
/// there without turning about the guide; HairBatch in mane/v1/groom.proto has the formulas. So
/// every frame's points give every hair: AssembleHairs().
struct Hairs {
  double offset_unit_m = 0;                 ///< [m], in [1e-9, 1e-3].
  std::vector<std::uint32_t> guides;        ///< That each rides on, not decreasing, (hair).
  std::vector<std::uint16_t> point_counts;  ///< Control points, 2 to 1000, (hair).
  std::vector<HairPlace> places;      ///< Root first, parts not decreasing in a hair, (point).
  std::vector<std::uint8_t> colours;  ///< sRGB, (hair, 3); empty for none.
};

/// The hairs of a groom, and what else it takes to assemble them.
struct GroomHairs {
  Hairs hairs;
  std::vector<Quaternion> root_frames;  ///< Of the guides, head frame, (guide).
};

/// Control points of all hairs in a frame: `out` is (point, 3) [m], in the frame's space. About 30
/// ns a point; no allocation.
///
/// @param positions         Frame::positions: (guide, point, 3) [m].
/// @param points_per_guide  Frame::points_per_guide, 2 to 256.
/// @param head_orientation  Frame::head_pose.orientation for Space::kWorld, {} for Space::kHead.
/// @return kInvalidArgument naming what does not fit: `positions`, `points_per_guide`, `hairs`,
/// `out`.
Result<void> AssembleHairs(const GroomHairs& groom, std::span<const float> positions,
                           std::uint32_t points_per_guide, const Quaternion& head_orientation,
                           std::span<float> out);

}  // namespace mane::inline client
