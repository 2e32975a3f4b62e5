#pragma once

#include <Eigen/Core>

#include <vector>

namespace mane::head {

/// What a head that has changed its model shows besides the new one's own shape: the vectors from
/// point to point of every guide differ by these, less and less.
struct Transition {
  int points = 0;    ///< Of each guide, as the head's view has them; 0 for no transition.
  double begin = 0;  ///< As HeadState::time [s].
  std::vector<Eigen::Vector3f> offsets;  ///< Head's axes [m], (guides x (points - 1)).
};

/// How long it takes [s].
inline constexpr double kTransitionTime = 0.25;

/// Of its offsets, what is shown at `time`: from 1 to 0, without a kink.
[[nodiscard]] double Remaining(const Transition& transition, double time);

}  // namespace mane::head
