#pragma once

#include "contact/wisp_approach.h"

namespace mane::contact {

/// The pair of a contact: where it is, on which side, what it asks for; all but `mass` and
/// `impulse` (H4 to H10). It goes on from `old`, or begins where that is null.
[[nodiscard]] WispPair MakePair(const WispPoints& points, const WispStep& step,
                                const WispSettings& settings, const WispScratch& scratch,
                                const WispScratch::Contact& contact, const WispPair* old);

/// Whether the pair's impulse may become other than zero within the step; by that its points'
/// masses are shared out.
[[nodiscard]] bool MayTouch(const WispPair& pair, float dt);

/// Velocity of one side where it touches [m/s].
[[nodiscard]] Eigen::Vector3f SideVelocity(const WispPair& pair, int side,
                                           const VelocitySpans& velocities);

/// Sets the pair's masses by what its guides have been found to weigh (H11).
void SetMasses(const std::vector<Heaviness>& heaviness, WispPair& pair);

/// Sets the impulse of the first pass: what would stop the pair at the last step's velocities; or
/// `steady`, what it has pushed with [kg m/s], if that is more (H7).
void StartImpulse(float steady, WispPair& pair);

/// Sums over a guide's pairs of what tells how heavy it is.
class Weighing {
 public:
  /// Adds what the pair's side met in the last pass and this one.
  ///
  /// @param pass  0 for the first of a step, which tells something of impacts only.
  void Add(const WispPair& pair, int side, int pass);
  /// Changes `heaviness` to what was found, where anything was.
  void Finish(Heaviness& heaviness) const;

 private:
  struct Sums {
    double size = 0, size_2 = 0;  // Of changes of impulse, and squared.
    double alone = 0;             // Power of what the points alone would have done,
    double moved = 0;             // and of what they did.
  };
  Sums sums_[2];  // Along normals, and across.
  bool impact_ = false;
};

/// Finds the impulse for the next pass from the velocities that the present one led to (H8 to H10,
/// H12).
void ReviseImpulse(WispPair& pair);

}  // namespace mane::contact
