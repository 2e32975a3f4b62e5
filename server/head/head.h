#pragma once

#include <Eigen/Core>

#include <span>
#include <vector>

#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "head/beam_motion.h"
#include "head/contact.h"
#include "head/detail.h"
#include "head/transition.h"
#include "head/wind.h"
#include "math/rigid.h"
#include "rod/batch.h"
#include "rod/scheme.h"
#include "rod/step.h"

namespace mane::head {

/// What surrounds a head: gravity, mean wind and factors on the guides' damping, and how the wind
/// varies.
struct Environment : rod::Surroundings {
  WindVariation wind_variation;
  /// How far tips may be off [m] where blocks of guides that bend little are stepped with fewer
  /// elements (rod.md, Detail); 0 for full detail. Acts once StartDetail has given the head its
  /// levels.
  double detail_tolerance = 0;
};

/// Every mutable number of one animated head. One owner at a time; copy it to keep a checkpoint.
struct HeadState {
  double time = 0;                      ///< Simulated so far [s]; what the wind varies by.
  math::Pose pose;                      ///< head -> world: where the roots are clamped.
  std::vector<rod::Row<float>> guides;  ///< As Groom::batch packs them, (state_rows).
  Detail detail;                        ///< Which of them are stepped with fewer elements.
  Contact contact;                      ///< What they meet.
  BeamState beams;        ///< What moves in place of all this where the guides are beams.
  Transition transition;  ///< Of a change between the two.
};

/// The groom's rest shape on a head at `pose`, standing still.
[[nodiscard]] HeadState AtRest(const groom::Groom& groom, const math::Pose& pose);

/// Puts the hair to its rest shape, or that to which it settled among bodies, standing still; the
/// pose stays.
void Reset(const groom::Groom& groom, HeadState* state);

/// Element angles of all guides, or unknowns of wound ones [rad], (coordinates of all guides).
[[nodiscard]] std::vector<double> Coordinates(const groom::Groom& groom, const HeadState& state);

/// Moves head, hair and moving bodies together as one rigid body: shapes stay, velocities turn
/// along.
void Teleport(const groom::Groom& groom, const math::Pose& pose, HeadState* state);

using rod::kLongestStep;

/// One movement of the head: to `target` within `duration` [s] > 0 at constant velocity, in
/// `substeps` >= 1 equal time steps; more of them where they would be longer than kLongestStep.
struct Movement {
  math::Pose target;
  double duration;
  int substeps;
  /// World poses that the moving bodies reach meanwhile, likewise, (Bodies::moving_count); empty
  /// where they stay as they are.
  std::span<const math::Pose> bodies = {};
};

/// A head that moves faster [m/s] has been cut to another place: it is teleported there.
inline constexpr double kFastestHead = 300;

/// A copy of `state` with every block at full detail: the same shapes and rates, velocities that go
/// with them.
[[nodiscard]] HeadState FullDetail(const groom::Groom& groom, HeadState state);

/// Elements that the next step will take, of all guides; of beams, segments.
[[nodiscard]] int SteppedElements(const groom::Groom& groom, const HeadState& state);

/// Time steps that a movement takes.
[[nodiscard]] int StepCount(const Movement& movement);

/// What a step reports besides the state.
struct StepReport {
  int repaired_guides =
      0;  ///< Guides that became non-finite and were put to rest; 0 unless at fault.
};

/// Advances all guides along `movement`. A pure function of its arguments: the pool decides only
/// who computes, so results are the same bits for any number of workers. Beams meet nothing but
/// their hull: bodies move, and hair does not see it.
StepReport Advance(const groom::Groom& groom, const Movement& movement,
                   const Environment& environment, HeadState* state, exec::WorkerPool& pool);

}  // namespace mane::head
