#include "contact/strand_contact.h"

#include <algorithm>
#include <cmath>

#include "rod/chain.h"
#include "rod/scheme.h"

namespace mane::contact {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Of a point's own mass: what resists penetration and what holds it sideways within a step (K2,
// K3). Weight alone thus presses hair in by g h dt / kPressing, some micrometres at 60 Hz, and a
// point that is held creeps by g h / kHolding, a micrometre a second.
constexpr double kPressing = 1e3;
constexpr double kHolding = 1e5;
// Solutions with loads, after one without (K5).
constexpr int kPasses = 6;
constexpr int kLate = 3;  // From this one on none is let go.
constexpr int kCorrections = 4;
// Points farther from a body than this many times what they move in a step are not looked at.
constexpr double kReach = 4;

// A point of the strand and one obstacle near it.
struct Meeting {
  int element;
  double fraction;
  double mass;  // That the point stands for [kg].
  const Friction* friction;
  double gap;         // At the extrapolated shape [m],
  double allowed;     // and what it may be [m], <= 0 (K1).
  Vector3d normal;    // Out of the obstacle.
  Vector3d tangent;   // Of the strand, root to tip.
  Vector3d last;      // Velocity that led to the extrapolated shape [m/s].
  Vector3d surface;   // The obstacle's [m/s].
  Vector3d base;      // The clamp's part of the velocity [m/s].
  Eigen::MatrixXd J;  // Velocity per rate, (3 x 3N).
  enum class State { kFree, kHeld, kSliding } state = State::kFree;
  bool stopped = false;  // Must not come nearer than it is.
  // Of the last solution: normal impulse [kg m/s], and velocity over the surface [m/s].
  double pressing = 0;
  Vector3d slip = Vector3d::Zero();

  [[nodiscard]] Vector3d Velocity(const Eigen::VectorXd& rate) const { return base + J * rate; }
  // Velocity along the normal at which it would end the step just as deep as it may (K2) [m/s].
  [[nodiscard]] double Least(double dt) const {
    const double h = rod::kTheta * dt;
    const double least = (allowed - gap + normal.dot(h * last + (dt - h) * surface)) / dt;
    return stopped ? std::max(least, normal.dot(surface)) : least;
  }
  // Normal impulse (K2) [kg m/s].
  [[nodiscard]] double Pressing(double dt, const Vector3d& u) const {
    return kPressing * mass * (Least(dt) - normal.dot(u));
  }
};

Eigen::VectorXd Stack(std::span<const Vector3d> vectors) {
  Eigen::VectorXd all(3 * vectors.size());
  for (size_t i = 0; i < vectors.size(); ++i) all.segment<3>(3 * i) = vectors[i];
  return all;
}

std::vector<Meeting> FindMeetings(const rod::Strand& strand, const rod::ClampMotion& clamp,
                                  std::span<const Obstacle> obstacles,
                                  const ContactSettings& settings, const rod::StrandState& state) {
  const double h = rod::kTheta * clamp.dt;
  const math::Pose root = math::Interpolate(clamp.begin, clamp.end, rod::kTheta);
  const Vector3d velocity = (clamp.end.p - clamp.begin.p) / clamp.dt;
  const Vector3d spin = math::RotationVector(clamp.end.q * clamp.begin.q.conjugate()) / clamp.dt;
  const Eigen::VectorXd rate = Stack(state.rate);
  std::vector<Vector3d> theta(state.theta.begin(), state.theta.end());
  for (size_t Q = 0; Q < theta.size(); ++Q) theta[Q] += h * state.rate[Q];
  const std::vector<rod::ElementFrame> frames = rod::ElementFrames(strand, root, theta);

  std::vector<Meeting> meetings;
  double before = 0;  // Arc length of the element's left end.
  for (int Q = 0; Q < strand.elements(); ++Q) {
    const double l = strand.length[Q];
    for (int k = 1; k <= settings.points_per_element; ++k) {
      const double fraction = static_cast<double>(k) / settings.points_per_element;
      if (before + fraction * l < settings.root_length) continue;
      const rod::PointKinematics point = rod::PointAt(strand, root, theta, {Q, fraction});
      const Vector3d base = velocity + spin.cross(point.r - root.p);
      const Vector3d last = base + point.J * rate;
      for (const Obstacle& obstacle : obstacles) {
        const BodyDistance at = At({&obstacle.body, 1}, rod::kTheta, point.r);
        const double gap = at.distance.distance - settings.thickness;
        const double way = h * (last - at.velocity).norm();
        const double start = gap - h * at.distance.normal.dot(last - at.velocity);
        if (gap > kReach * way + settings.thickness) continue;
        Meeting meeting{.element = Q,
                        .fraction = fraction,
                        .mass = strand.linear_density * l / settings.points_per_element,
                        .friction = &obstacle.friction,
                        .gap = gap,
                        .allowed = std::min(0.0, start + settings.recovery_speed * clamp.dt),
                        .normal = at.distance.normal,
                        .tangent = frames[Q].R * rod::EndOfElement(fraction * theta[Q]).E.col(0),
                        .last = last,
                        .surface = at.velocity,
                        .base = base,
                        .J = point.J};
        meetings.push_back(std::move(meeting));
      }
    }
    before += l;
  }
  return meetings;
}

// What the next solution must do, after one with velocities by `rate` (K5).
void Revise(double dt, const Eigen::VectorXd& rate, bool late, Meeting* meeting) {
  const Vector3d u = meeting->Velocity(rate);
  meeting->pressing = meeting->Pressing(dt, u);
  if (!(meeting->pressing > 0)) {
    meeting->pressing = 0;
    // One that is let go late would fall in. It is stopped where it is, which only takes energy.
    if (late && meeting->state != Meeting::State::kFree) {
      meeting->stopped = true;
    } else {
      meeting->state = Meeting::State::kFree;
    }
    return;
  }
  if (meeting->state == Meeting::State::kFree) {
    meeting->state = Meeting::State::kHeld;
    return;
  }
  const Vector3d across = u - meeting->surface;
  const Vector3d slip = across - meeting->normal * meeting->normal.dot(across);
  if (meeting->state == Meeting::State::kSliding) {
    // Friction does not turn sliding round: it ends it.
    if (slip.dot(meeting->slip) <= 0) meeting->state = Meeting::State::kHeld;
  } else {
    const double mu = meeting->friction->Coefficient(slip, meeting->tangent);
    const bool holds = kHolding * meeting->mass * slip.norm() <= mu * meeting->pressing;
    if (!holds) meeting->state = Meeting::State::kSliding;
  }
  meeting->slip = slip;
}

// Friction of what slides is a force of known size while the solutions look for its direction, and
// a resistance to the velocity found in the last one, which cannot give energy (K4).
rod::PointLoad LoadOf(double dt, const Meeting& m, bool last) {
  const Matrix3d normal = m.normal * m.normal.transpose();
  const double pressing = kPressing * m.mass;
  rod::PointLoad load{m.element,         m.fraction,
                      pressing * normal, pressing * m.Least(dt) * m.normal,
                      m.normal,          m.normal.dot(m.surface)};
  double hold = kHolding * m.mass;
  if (m.state == Meeting::State::kSliding) {
    const double rub = m.friction->Coefficient(m.slip, m.tangent) * m.pressing;
    if (!last) {
      load.p -= rub * m.slip.normalized();
      return load;
    }
    hold = std::min(hold, rub / m.slip.norm());
  }
  const Matrix3d across = hold * (Matrix3d::Identity() - normal);
  load.W += across;
  load.p += across * m.surface;
  return load;
}

// Revises all meetings after solution `pass`. Whether there is anything to solve again.
bool ReviseAll(double dt, const Eigen::VectorXd& rate, int pass, std::vector<Meeting>* meetings) {
  bool touching = false;
  for (Meeting& meeting : *meetings) {
    Revise(dt, rate, pass >= kLate, &meeting);
    touching |= meeting.state != Meeting::State::kFree;
  }
  return touching || pass > 0;
}

// Stops what its own spring pulls to the surface, which would give energy (K6). Whether any was.
bool Correct(double dt, const Eigen::VectorXd& rate, std::vector<Meeting>* meetings) {
  bool any = false;
  for (Meeting& meeting : *meetings) {
    if (meeting.state == Meeting::State::kFree || meeting.stopped) continue;
    const Vector3d u = meeting.Velocity(rate);
    if (meeting.Pressing(dt, u) >= 0 || meeting.normal.dot(u - meeting.surface) >= 0) continue;
    meeting.stopped = any = true;
  }
  return any;
}

}  // namespace

ContactReport StepWithContact(const rod::Strand& strand, const rod::ClampMotion& clamp,
                              const rod::Surroundings& air, std::span<const Obstacle> obstacles,
                              const ContactSettings& settings, rod::StrandState state,
                              ContactScratch& scratch) {
  std::vector<Meeting> meetings = FindMeetings(strand, clamp, obstacles, settings, state);
  scratch.loads.clear();
  for (int pass = 0; pass < kPasses + kCorrections; ++pass) {
    scratch.theta.assign(state.theta.begin(), state.theta.end());
    scratch.rate.assign(state.rate.begin(), state.rate.end());
    scratch.velocity.assign(state.velocity.begin(), state.velocity.end());
    if (!rod::Step(strand, clamp, air, scratch.loads,
                   {scratch.theta, scratch.rate, scratch.velocity}, scratch.step)) {
      return {.finite = false};
    }
    const Eigen::VectorXd rate = Stack(scratch.rate);
    const bool solved = pass < kPasses ? !ReviseAll(clamp.dt, rate, pass, &meetings)
                                       : !Correct(clamp.dt, rate, &meetings);
    if (solved) break;
    scratch.loads.clear();
    for (const Meeting& meeting : meetings) {
      if (meeting.state == Meeting::State::kFree) continue;
      scratch.loads.push_back(LoadOf(clamp.dt, meeting, pass + 1 >= kPasses));
    }
  }
  std::ranges::copy(scratch.theta, state.theta.begin());
  std::ranges::copy(scratch.rate, state.rate.begin());
  std::ranges::copy(scratch.velocity, state.velocity.begin());
  ContactReport report;
  for (const Meeting& meeting : meetings) {
    report.touching += meeting.state != Meeting::State::kFree;
    report.sliding += meeting.state == Meeting::State::kSliding;
  }
  return report;
}

}  // namespace mane::contact
