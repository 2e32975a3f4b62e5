#include "contact/wisp_impulse.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>

namespace mane::contact {
namespace {

using Eigen::Vector3f;

constexpr double kGravity = 9.81;  // What presses wisps together at rest [m/s^2].
constexpr float kDamping = 2;      // Of the wisps' compression, 1 is critical.
constexpr float kHeaviest = 64;    // Strands make a pair heavier by this at most,
constexpr float kFastestRise = 8;  // and by this from one pass to the next.
constexpr float kFastest = 100;    // Wisps that are faster count as this fast [m/s].
constexpr float kStaticSpeed = 1;  // A push may always stop this much [m/s].
constexpr float kImpact = 0.3f;    // What comes faster tells how heavy it is by how it stops [m/s].
constexpr float kLeastChange = 1e-4f;  // Velocities that change less tell nothing [m/s].

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

// (H11): how heavy the pair was along the change of its impulse, by its mass.
float Heaviness(float change_of_impulse, float change_of_velocity, float mass, float before) {
  if (!(std::abs(change_of_velocity) > kLeastChange)) return before;
  const float factor = change_of_impulse / (mass * change_of_velocity);
  if (!(factor > 0)) return before;
  return std::clamp(factor, std::max(1.0f, before / kFastestRise),
                    std::min(kHeaviest, before * kFastestRise));
}

float Mix(double straight, double curly, float curliness) {
  return static_cast<float>(straight + (curly - straight) * curliness);
}

}  // namespace

WispPair MakePair(const WispPoints& points, const WispStep& step, const WispSettings& settings,
                  const WispScratch::Contact& contact, const WispPair* old) {
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
  const auto relaxed =
      static_cast<float>(-std::expm1(-step.dt / std::max(1e-3, settings.relaxation_time)));
  pair.reference = old ? old->reference + relaxed * (at_rest_apart - old->reference)
                       : std::min(at_rest_apart, contact.start.norm());
  pair.gap = contact.start.dot(pair.normal) - pair.reference;

  // What it asks for.
  const auto recovery = static_cast<float>(settings.recovery_speed);
  const float frequency_2 = static_cast<float>(kGravity / settings.compression) / reach;
  const float stiffness = frequency_2 * step.h * step.dt;
  const float damping = 2 * kDamping * std::sqrt(frequency_2) * step.h;
  pair.spring = stiffness + damping;
  pair.target = pair.gap >= 0 ? -pair.gap / step.dt
                              : std::min(-pair.gap / step.dt, recovery) * stiffness / pair.spring;
  const float curly = 0.5f * (curliness(0) + curliness(1));
  const float hooked = curliness(0) * curliness(1);
  pair.viscosity = step.h * Mix(settings.sliding_rate_straight, settings.sliding_rate_curly, curly);
  pair.friction = Mix(settings.friction_straight, settings.friction_curly, curly);
  pair.cohesion = step.h * static_cast<float>(settings.cohesion_rate) * hooked;
  const float range = static_cast<float>(settings.touch_range) * reach;
  pair.nearness = pair.gap <= 0 ? 1 : std::max(0.0f, 1 - pair.gap / std::max(range, 1e-9f));

  pair.last_velocity = RelativeVelocity(pair, points.velocity);
  pair.fastest = std::min(pair.last_velocity.norm(), kFastest);
  pair.leaving = recovery;
  pair.impact = kImpact + static_cast<float>(kGravity) * step.dt;
  pair.normal_factor = old ? old->normal_factor : 1;
  pair.sliding_factor = old ? old->sliding_factor : 1;
  return pair;
}

void StartImpulse(float steady, WispPair& pair) {
  const float stop = pair.spring / (1 + pair.spring) * pair.mass * pair.normal_factor *
                     (pair.target - pair.last_velocity.dot(pair.normal));
  pair.impulse = std::max({0.0f, steady, stop}) * pair.normal;
  pair.last_impulse = steady * pair.normal;
}

bool MayTouch(const WispPair& pair, float dt) {
  return pair.nearness > 0 || pair.gap + dt * pair.last_velocity.dot(pair.normal) < 0;
}

Vector3f RelativeVelocity(const WispPair& pair, const VelocitySpans& velocities) {
  const auto at = [&](int k) {
    const auto p = static_cast<size_t>(pair.point[k]);
    const Vector3f u = velocities[p];
    return Vector3f(u + pair.fraction[k] * (velocities[p + 1] - u));
  };
  return at(0) - at(1);
}

void ReviseImpulse(const Vector3f& velocity, int pass, WispPair& pair) {
  const float speed = velocity.norm();
  if (!std::isfinite(speed)) {
    pair.impulse.setZero();
    return;
  }
  const Vector3f w = speed > kFastest ? Vector3f(velocity * (kFastest / speed)) : velocity;
  const Vector3f& n = pair.normal;
  pair.fastest = std::max(pair.fastest, std::min(speed, kFastest));

  // How heavy the strands make it (H11).
  if (pass > 0 || std::abs(pair.last_velocity.dot(n)) > pair.impact) {
    const Vector3f dP = pair.impulse - pair.last_impulse, dw = w - pair.last_velocity;
    const float dPn = dP.dot(n), dwn = dw.dot(n);
    const Vector3f dPt = dP - dPn * n, dwt = dw - dwn * n;
    pair.normal_factor = Heaviness(dPn, dwn, pair.mass, pair.normal_factor);
    const float along = dPt.norm();
    if (along > 0) {
      pair.sliding_factor = Heaviness(along, dwt.dot(dPt) / along, pair.mass, pair.sliding_factor);
    }
  }
  pair.last_velocity = w;
  pair.last_impulse = pair.impulse;

  // Along the normal: a push (H8), or what holds (H10).
  const float m = pair.mass * pair.normal_factor;
  const float wn = w.dot(n), Pn = pair.impulse.dot(n);
  const float push =
      std::max(0.0f, pair.spring / (1 + pair.spring) * (m * (pair.target - wn) + Pn));
  const float hold = pair.nearness * pair.cohesion;
  const float held = std::min(0.0f, hold / (1 + hold) * (Pn - m * wn));
  const float stopped = std::clamp(Pn - m * (wn - pair.leaving), -pair.rebound, 0.0f);
  const float along = push > 0 ? push : std::min(held, stopped);

  // Across: part of what would stop the sliding (H9).
  const Vector3f wt = w - wn * n, Pt = pair.impulse - Pn * n;
  const Vector3f stop = Pt - pair.mass * pair.sliding_factor * wt;
  const float viscous = (push > 0 ? 1 : pair.nearness) * pair.viscosity;
  const float part = viscous / (1 + viscous) + pair.friction * push / std::max(stop.norm(), 1e-30f);
  pair.impulse = along * n + std::min(part, 1.0f) * stop;

  // Never more than it could need (H12).
  const float most = pair.mass * std::max(pair.normal_factor, pair.sliding_factor) *
                     (2 * pair.fastest + kStaticSpeed);
  const float size = pair.impulse.norm();
  if (size <= most) return;
  pair.impulse = std::isfinite(size) ? Vector3f(pair.impulse * (most / size)) : Vector3f::Zero();
}

}  // namespace mane::contact
