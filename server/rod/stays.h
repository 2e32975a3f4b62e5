#pragma once

#include <Eigen/Core>

#include <span>

#include "math/rigid.h"
#include "rod/strand.h"

namespace mane::rod {

/// Whether a strand stays where it is put.
struct StayReport {
  bool stays = false;
  double tip = 0;       ///< Largest distance of the tip from where it was put [m].
  double farthest = 0;  ///< The same of any element end [m].
};

/// Steps a strand for eight seconds in still air, from a shape whose angles are off by about 1e-6
/// rad each, as those of float32 are (rod.md, I5). It stays if no element end comes farther than
/// 1e-3 of the length, and none farther in the last three seconds than in the three before. Once
/// one has, the rest is stepped all the same: it tells where the strand goes.
///
/// 1.2 us an element and step. Same arguments, same bits.
///
/// @param gravity  [m/s^2], in the frame of `clamp`'s parent.
/// @param dt       of every step [s], > 0; the longest one that is to stay.
/// @param theta    in: the shape [rad], (N), an equilibrium; out: that at the end.
[[nodiscard]] StayReport Stays(const Strand& strand, const math::Pose& clamp,
                               const Eigen::Vector3d& gravity, double dt,
                               std::span<Eigen::Vector3d> theta);

}  // namespace mane::rod
