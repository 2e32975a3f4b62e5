#pragma once

#include <span>
#include <vector>

#include "contact/body.h"
#include "contact/friction.h"
#include "rod/step.h"

namespace mane::contact {

/// A body and how hair rubs on it.
struct Obstacle {
  Body body;  ///< Moving over the step, in the world.
  Friction friction;
};

/// How a strand meets obstacles.
struct ContactSettings {
  int points_per_element = 3;  ///< Along the centreline, at equal arc length, right end included.
  double thickness = 5e-4;     ///< The centreline keeps this far from surfaces [m], >= 0.
  /// The first of the strand is not looked at [m]: it leaves the skin there.
  double root_length = 0.005;
  double recovery_speed = 0.2;  ///< At which what lies deep inside comes out [m/s].
};

/// Memory of one worker.
struct ContactScratch {
  rod::StepScratch step;
  std::vector<Eigen::Vector3d> theta, rate, velocity;
  std::vector<rod::PointLoad> loads;
};

/// What a step with contact reports.
struct ContactReport {
  bool finite = true;  ///< As rod::Step says.
  int touching = 0;    ///< Points that press on an obstacle at the end,
  int sliding = 0;     ///< and those of them that slide.
};

/// Advances a plain strand by one step among obstacles (contact.md, K1 to K6): rod::Step in double
/// precision, three times, with the loads that each solution asks for. The reference for the
/// batched kernels. Bounded at any size of step, as rod::Step is.
[[nodiscard]] ContactReport StepWithContact(const rod::Strand& strand,
                                            const rod::ClampMotion& clamp,
                                            const rod::Surroundings& air,
                                            std::span<const Obstacle> obstacles,
                                            const ContactSettings& settings, rod::StrandState state,
                                            ContactScratch& scratch);

}  // namespace mane::contact
