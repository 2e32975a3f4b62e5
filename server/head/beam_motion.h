#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <memory>
#include <vector>

#include "head/beams.h"
#include "math/rigid.h"
#include "rod/scheme.h"
#include "simd/rows.h"

namespace mane::head {

/// What moves while a head's guides are beams, and what is remembered for that meanwhile.
struct BeamState {
  /// Null before StartBeams.
  std::shared_ptr<const Beams> beams;
  /// What the head is animated by: beams where it is set, else rods.
  bool active = false;
  std::vector<simd::Row<float>> rows;  ///< Of the beams' batch; empty unless active.
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  ///< Of the head in the last step [m/s].
  Eigen::Vector3d spin = Eigen::Vector3d::Zero();      ///< [rad/s]
  double duration = rod::kLongestStep;                 ///< Of the last step [s].
  uint64_t steps = 0;                                  ///< That beams have made.
};

struct Environment;
struct HeadState;
struct Movement;

/// Puts beams to their rest directions on a head at `pose`, standing still.
void PutBeamsToRest(const math::Pose& pose, BeamState* state);

/// Turns beams along with a head that is teleported.
void TurnBeams(const Eigen::Quaterniond& turn, BeamState* state);

/// The part of Advance that is about beams, where these are active: steps them, in blocks of
/// guides, along `movement`. Returns guides that became non-finite and were put to rest.
int AdvanceBeams(const Movement& movement, const Environment& environment, HeadState* state,
                 exec::WorkerPool& pool);

/// Remembers how the head moved in the last step of `movement`, whatever its model.
void RememberMovement(const Movement& movement, HeadState* state);

}  // namespace mane::head
