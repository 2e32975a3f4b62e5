#pragma once

#include "contact/wisp_search.h"

namespace mane::contact {

/// The pair of a contact: where it is, on which side, what it asks for; all but `mass` and
/// `impulse` (H4 to H10). It goes on from `old`, or begins where that is null.
[[nodiscard]] WispPair MakePair(const WispPoints& points, const WispStep& step,
                                const WispSettings& settings, const WispScratch::Contact& contact,
                                const WispPair* old);

/// Whether the pair's impulse may become other than zero within the step; by that its points'
/// masses are shared out.
[[nodiscard]] bool MayTouch(const WispPair& pair, float dt);

/// Sets the impulse of the first pass: what would stop the pair at the last step's velocities, had
/// it only its own points' mass; or `steady`, what it has pushed with [kg m/s], if that is more
/// (H7).
void StartImpulse(float steady, WispPair& pair);

/// Velocity of the first wisp seen by the second where they touch [m/s].
[[nodiscard]] Eigen::Vector3f RelativeVelocity(const WispPair& pair,
                                               const VelocitySpans& velocities);

/// Finds the impulse for the next pass from the relative velocity that the present one led to (H8
/// to H12).
///
/// @param pass  0 for the first of a step.
void ReviseImpulse(const Eigen::Vector3f& velocity, int pass, WispPair& pair);

}  // namespace mane::contact
