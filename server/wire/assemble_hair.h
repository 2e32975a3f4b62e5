#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cstdint>
#include <span>

namespace mane::wire {

/// Points of the hairs that ride on a guide, from the guide's sampled points.
///
/// A guide's n sampled points P_0, ..., P_n-1 stand at equal arc length, root first, tip last, as
/// in a HairFrame of a format with positions. With the part s in [0, 1] of the guide's arc length,
/// x = s (n - 1), j = min(floor(x), n - 2) and u = x - j, a control point of a hair is
///
///     h = p(s) + F(s) o                                                            (A1)
///     p(s): the Catmull-Rom spline P_j -> P_j+1 at u, tangents m_k = (P_k+1 - P_k-1) / 2   (A2)
///     F(s): (1 - u) F_j + u F_j+1 of quaternions, normalised                       (A3)
///     F_0 = root frame, F_k = [T_k-1 -> T_k] F_k-1                                 (A4)
///
/// with the offset o [m] in the carried frame. Beyond its ends the guide goes on as a parabola:
/// P_-1 = 3 P_0 - 3 P_1 + P_2, of two points as a line. T_0 = F_0 e0 is the direction in which the
/// guide is clamped, T_k = m_k / |m_k|, and [T_k-1 -> T_k] is the double reflection of [WJZL08] (W.
/// Wang, B. Juettler, D. Zheng, Y. Liu, "Computation of Rotation Minimizing Frames", ACM
/// Transactions on Graphics 27, 2008): the quaternion (a x b, a . b) of the unit vectors along
///
///     a: P_k - P_k-1,    b: T_k - T_k-1 + 2 (a . T_k-1) a                          (A5)
///
/// negated where a . b < 0. It takes T_k-1 to T_k: F_k e0 = T_k, so that o_0 lies along the guide,
/// o_1 and o_2 across it, and F turns about the guide no more than it must (parallel transport, but
/// for the errors of m_k, of second order in the spacing). Where P_k - P_k-1 or m_k is shorter than
/// 1e-12 m, or the vector of (A5) for b than 1e-6, F_k = F_k-1 and T_k = T_k-1.
///
/// What follows: a rigid motion of points and root frame moves hairs rigidly, to rounding; an
/// offset of 0 lies on p; |h - p| = |o| however the guide bends. Points and root frame may be in
/// any one frame of reference. Other numbers of samples give other hairs: 1 cm from a guide of
/// 30 cm that winds twice, those of 16 points are 0.7 mm from those of many, of 32 points 0.2 mm.
///
/// All functions: pure; no allocation; float32, so that h is off by a few roundings of |P|.

/// Where one control point of a hair is on its guide: an entry of mane.v1.HairBatch.places, 8
/// bytes, little-endian.
struct HairPlace {
  uint16_t part = 0;                   ///< 65535 s.
  std::array<int16_t, 3> offset = {};  ///< o, in units of the groom's `hair_offset_unit_m`.

  bool operator==(const HairPlace&) const = default;
};
static_assert(sizeof(HairPlace) == 8 && alignof(HairPlace) == 2);

/// HairPlace::part at the tip.
inline constexpr int kTipPart = 65535;

/// A guide as hairs see it. Views; whoever makes it keeps them alive.
struct CarriedGuide {
  std::span<const Eigen::Vector3f> points;     ///< P_k [m], (n), n from 2 to 65536.
  std::span<const Eigen::Quaternionf> frames;  ///< F_k, unit, (n): CarryFrames of `points`.
};

/// F_k by (A4).
///
/// @param root    the guide's root frame, unit, in the frame of reference of `points`.
/// @param points  P_k [m], (n), n >= 2. @param frames  (n).
void CarryFrames(const Eigen::Quaternionf& root, std::span<const Eigen::Vector3f> points,
                 std::span<Eigen::Quaternionf> frames);

/// The points of a hair by (A1); of all hairs of one guide at once, if their places follow each
/// other.
///
/// @param unit  of the offsets [m]. @param out  [m], as many as `places`.
void AssembleHair(const CarriedGuide& guide, std::span<const HairPlace> places, float unit,
                  std::span<Eigen::Vector3f> out);

/// The inverse: the offset o [m] with which `point` [m] is at `part` of the guide.
[[nodiscard]] Eigen::Vector3f OffsetOf(const CarriedGuide& guide, uint16_t part,
                                       const Eigen::Vector3f& point);

}  // namespace mane::wire
