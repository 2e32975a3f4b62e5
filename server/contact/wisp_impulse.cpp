#include "contact/wisp_impulse.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace mane::contact {
namespace {

using Eigen::Vector3f;

constexpr double kGravity = 9.81;       // What presses wisps together at rest [m/s^2].
constexpr float kHeaviest = 64;         // A strand makes its points heavier by this at most,
constexpr float kHeaviestTogether = 3;  // and by this where it meets several others at rest.
// What ends a step nearer than its distance less this part of it passes (H18); that distance counts
// as this part of the sum of radii at least, where wisps lie deep in each other at rest.
constexpr float kPassing = 0.7f, kSeparate = 0.5f;
constexpr float kFastest = 100;    // Wisps that are faster count as this fast [m/s].
constexpr float kStaticSpeed = 1;  // A push may always stop this much [m/s].
constexpr float kImpact = 0.3f;    // What comes faster tells how heavy it is by how it stops [m/s].

// A direction across both segments, whatever they are.
Vector3f Across(const WispPoints& points, const int32_t point[2]) {
  const auto edge = [&](int32_t p) {
    const auto k = static_cast<size_t>(p);
    return Vector3f(points.Position(k + 1) - points.Position(k));
  };
  const Vector3f along = edge(point[0]), across = along.cross(edge(point[1]));
  if (across.norm() > 1e-2f * along.squaredNorm()) return across.normalized();
  return along.norm() > 0 ? along.unitOrthogonal() : Vector3f::UnitX();
}

float Mix(double straight, double curly, float curliness) {
  return static_cast<float>(straight + (curly - straight) * curliness);
}

// (H8): the push of the next pass, from the present one and the velocity that it led to.
float Push(const WispPair& pair, float velocity, float push) {
  const float m = pair.normal_mass;
  const float asked =
      pair.resistance / (m + pair.resistance) * (m * (pair.target - velocity) + push);
  return std::clamp(asked, 0.0f, std::max(0.0f, m * (pair.leaving - velocity) + push));
}

// The part that a resistance [kg] takes of the impulse that would stop a mass.
float Resisting(float resistance, float mass) { return resistance / (mass + resistance); }

}  // namespace

WispPair MakePair(const WispPoints& points, const WispStep& step, const WispSettings& settings,
                  const WispScratch& scratch, const WispScratch::Contact& contact,
                  const WispPair* old) {
  const auto of_guide = [&](const std::vector<float>& list, int k) {
    return list[static_cast<size_t>(contact.guide[k])];
  };
  const auto at_rest = [&](int k) {
    const auto p = static_cast<size_t>(contact.point[k]);
    return Vector3f(points.Rest(p) + contact.fraction[k] * (points.Rest(p + 1) - points.Rest(p)));
  };
  const float reach = SumOfRadii(points, contact.guide);
  const auto curliness = [&](int k) {
    const float c = points.curliness[static_cast<size_t>(contact.guide[k])];
    return c > 0 ? std::min(c, 1.0f) : 0;
  };

  WispPair pair{};
  pair.held.setZero();
  for (int k = 0; k < 2; ++k) {
    pair.guide[k] = contact.guide[k];
    pair.point[k] = contact.point[k];
    pair.fraction[k] = contact.fraction[k];
  }

  // The side it came from (H4).
  const float distance = contact.approach.norm();
  if (distance > 1e-3f * reach) {
    const Vector3f& from = old ? old->normal : contact.start;
    pair.normal = contact.approach / (contact.approach.dot(from) < 0 ? -distance : distance);
  } else {
    pair.normal = old ? old->normal : Across(points, contact.point);
  }

  // The distance to keep (H5).
  float at_rest_apart = reach;
  if (points.rest.size() > 0) {
    const float apart = (at_rest(0) - at_rest(1)).norm();
    if (apart < reach) at_rest_apart = apart;
  }
  if (old) {
    pair.reference = old->reference + step.relaxed * (at_rest_apart - old->reference);
  } else {
    pair.reference = step.first ? std::min(at_rest_apart, contact.start.norm()) : at_rest_apart;
  }
  pair.gap = contact.start.dot(pair.normal) - pair.reference;
  pair.passing_gap = -kPassing * std::max(pair.reference, kSeparate * reach);

  // What it asks for: a spring and a damper at the end of the step (H7).
  const float mass = std::min(of_guide(scratch.guide_mass, 0), of_guide(scratch.guide_mass, 1));
  const float stiffness = static_cast<float>(kGravity / settings.compression) * mass / reach;
  const float damping = stiffness * static_cast<float>(settings.expansion_time);
  const float velocity = -pair.gap / step.dt;
  pair.resistance = step.h * (stiffness * step.dt + damping);
  pair.target = step.h * (stiffness * step.dt * velocity + damping * std::min(velocity, 0.0f)) /
                pair.resistance;
  pair.leaving = static_cast<float>(settings.recovery_speed);
  const float curly = 0.5f * (curliness(0) + curliness(1));
  const float hooked = curliness(0) * curliness(1);
  pair.viscosity = step.h * Mix(settings.sliding_rate_straight, settings.sliding_rate_curly, curly);
  pair.friction = Mix(settings.friction_straight, settings.friction_curly, curly);
  pair.cohesion = step.h * static_cast<float>(settings.cohesion_rate) * hooked;
  const float range = static_cast<float>(settings.touch_range) * reach;
  pair.nearness = pair.gap <= 0 ? 1 : std::max(0.0f, 1 - pair.gap / std::max(range, 1e-9f));

  for (int k = 0; k < 2; ++k) pair.velocity[k] = SideVelocity(pair, k, points.velocity);
  pair.fastest = std::min((pair.velocity[0] - pair.velocity[1]).norm(), kFastest);
  pair.impact = kImpact + static_cast<float>(kGravity) * step.dt;
  return pair;
}

bool MayTouch(const WispPair& pair, float dt) {
  const float speed = (pair.velocity[0] - pair.velocity[1]).dot(pair.normal);
  return pair.nearness > 0 || pair.gap + dt * speed < 0;
}

Vector3f SideVelocity(const WispPair& pair, int side, const VelocitySpans& velocities) {
  const auto p = static_cast<size_t>(pair.point[side]);
  const Vector3f u = velocities[p];
  return u + pair.fraction[side] * (velocities[p + 1] - u);
}

void SetMasses(const std::vector<Heaviness>& heaviness, WispPair& pair) {
  float normal = 0, sliding = 0;
  for (int k = 0; k < 2; ++k) {
    const Heaviness& heavy = heaviness[static_cast<size_t>(pair.guide[k])];
    normal += pair.inverse_mass[k] / heavy.normal;
    sliding += pair.inverse_mass[k] / heavy.sliding;
  }
  pair.normal_mass = 1 / normal;
  pair.sliding_mass = 1 / sliding;
}

void StartImpulse(float steady, WispPair& pair) {
  const float stop = Push(pair, (pair.velocity[0] - pair.velocity[1]).dot(pair.normal), 0);
  const Vector3f held = steady > 0 ? pair.held : Vector3f(Vector3f::Zero());
  pair.impulse = std::max(steady, stop) * pair.normal + held;
  pair.last_impulse = steady * pair.normal + held;
  for (int k = 0; k < 2; ++k) pair.last_velocity[k] = pair.velocity[k];
}

void Weighing::Add(const WispPair& pair, int side, int pass) {
  const Vector3f& n = pair.normal;
  const float approach = (pair.last_velocity[0] - pair.last_velocity[1]).dot(n);
  const bool impact = std::abs(approach) > pair.impact;
  if (pass == 0 && !impact) return;
  const Vector3f dP = (side == 0 ? 1.0f : -1.0f) * (pair.impulse - pair.last_impulse);
  const Vector3f du = pair.velocity[side] - pair.last_velocity[side];
  const float dPn = dP.dot(n), dun = du.dot(n);
  const Vector3f dPt = dP - dPn * n;
  const double size_2[2] = {dPn * dPn, dPt.squaredNorm()}, moved[2] = {dPn * dun, dPt.dot(du)};
  for (int k = 0; k < 2; ++k) {
    if (!std::isfinite(size_2[k]) || !std::isfinite(moved[k])) continue;
    Sums& sums = sums_[k];
    sums.size += std::sqrt(size_2[k]);
    sums.size_2 += size_2[k];
    sums.alone += pair.inverse_mass[side] * size_2[k];
    sums.moved += moved[k];
  }
  impact_ = impact_ || impact;
}

void Weighing::Finish(Heaviness& heaviness) const {
  float* const factors[2] = {&heaviness.normal, &heaviness.sliding};
  for (int k = 0; k < 2; ++k) {
    const Sums& sums = sums_[k];
    if (!(sums.alone > 0) || !(sums.moved > 0)) continue;
    // One contact of equally changed ones, or about how many of them.
    const bool one = sums.size * sums.size < 1.5 * sums.size_2;
    const double most = one || impact_ ? kHeaviest : kHeaviestTogether;
    *factors[k] = static_cast<float>(std::clamp(sums.alone / sums.moved, 1.0, most));
  }
}

void ReviseImpulse(WispPair& pair) {
  const Vector3f velocity = pair.velocity[0] - pair.velocity[1];
  const float speed = velocity.norm();
  for (int k = 0; k < 2; ++k) pair.last_velocity[k] = pair.velocity[k];
  pair.last_impulse = pair.impulse;
  if (!std::isfinite(speed)) {
    pair.impulse.setZero();
    return;
  }
  const Vector3f w = speed > kFastest ? Vector3f(velocity * (kFastest / speed)) : velocity;
  const Vector3f& n = pair.normal;
  pair.fastest = std::max(pair.fastest, std::min(speed, kFastest));

  // Along the normal: a push (H8), or what holds (H10).
  const float mass = 1 / (pair.inverse_mass[0] + pair.inverse_mass[1]);
  const float wn = w.dot(n), Pn = pair.impulse.dot(n);
  const float push = Push(pair, wn, Pn);
  const float held =
      std::min(0.0f, Resisting(pair.nearness * pair.cohesion * mass, pair.normal_mass) *
                         (Pn - pair.normal_mass * wn));
  const float stopped =
      std::clamp(Pn - pair.normal_mass * (wn - pair.leaving), -pair.rebound, 0.0f);
  const float along = push > 0 ? push : std::min(held, stopped);

  // Across: part of what would stop the sliding (H9).
  const Vector3f wt = w - wn * n, Pt = pair.impulse - Pn * n;
  const Vector3f stop = Pt - pair.sliding_mass * wt;
  const float part =
      Resisting((push > 0 ? 1 : pair.nearness) * pair.viscosity * mass, pair.sliding_mass) +
      pair.friction * push / std::max(stop.norm(), 1e-30f);
  pair.impulse = along * n + std::min(part, 1.0f) * stop;

  // Never more than it could need (H12).
  const float most = kHeaviest * mass * (2 * pair.fastest + kStaticSpeed);
  const float size = pair.impulse.norm();
  if (size <= most) return;
  pair.impulse = std::isfinite(size) ? Vector3f(pair.impulse * (most / size)) : Vector3f::Zero();
}

}  // namespace mane::contact
