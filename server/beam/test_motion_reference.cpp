#include "beam/test_motion_reference.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "beam/bend.h"
#include "beam/test_motion.h"

namespace mane::beam::fixtures {
namespace {

using std::numbers::pi;

double Wrap(double x) { return std::remainder(x, 2 * pi); }

Vector3d E(double t, double f) {
  return {std::sin(t) * std::sin(f), std::cos(t), std::sin(t) * std::cos(f)};
}
Vector3d U(double t, double f) {
  return {std::cos(t) * std::sin(f), -std::sin(t), std::cos(t) * std::cos(f)};
}
Vector3d V(double f) { return {std::cos(f), 0, -std::sin(f)}; }

Vector3d Across(const Vector3d& a, const Vector3d& e) { return a - a.dot(e) * e; }

// The rotation by 2 atan(|delta| / 2) of a direction along delta.
Matrix3d Turn(const Vector3d& e, const Vector3d& delta) {
  const double size = delta.norm();
  if (size == 0) return Matrix3d::Identity();
  return Eigen::AngleAxisd(2 * std::atan(size / 2), e.cross(delta) / size).toRotationMatrix();
}

// B12: the step of a corrected direction.
Vector3d Moved(const Vector3d& from, const Vector3d& to) {
  const double cosine = from.dot(to), sine = std::sqrt(std::max(0.0, 1 - cosine * cosine));
  if (sine == 0) return Vector3d::Zero();
  const double angle = sine + std::pow(sine, 3) / 6 + 3 * std::pow(sine, 5) / 40;
  return angle / sine * (cosine * to - from);
}

uint32_t Mix(uint32_t x) {
  x ^= x >> 16;
  x *= 0x7feb352dU;
  x ^= x >> 15;
  x *= 0x846ca68bU;
  return x ^ (x >> 16);
}

// The branchless basis of a direction.
void Basis(const Vector3d& e, Vector3d* u, Vector3d* v) {
  const double sign = e.z() < 0 ? -1 : 1, a = -1 / (sign + e.z()), b = e.x() * e.y() * a;
  *u = {1 + sign * e.x() * e.x() * a, sign * b, -sign * e.x()};
  *v = {b, sign + e.y() * e.y() * a, -e.y()};
}

Vector3d Drawn(const MotionSettings& settings, uint64_t frame, int index, int segment,
               const Vector3d& e) {
  const uint64_t key = math::RandomStream(settings.seed, frame / 10).Bits();
  double part[2];
  for (int axis = 0; axis < 2; ++axis) {
    const uint32_t hair = Mix(static_cast<uint32_t>(index) ^ static_cast<uint32_t>(key));
    const uint32_t draw = Mix(hair ^ (static_cast<uint32_t>(key >> 32) + 2 * segment + axis));
    part[axis] = settings.fluctuation * ((draw >> 8) * 0x1p-23 - 1);
  }
  Vector3d u, v;
  Basis(e, &u, &v);
  return part[0] * u + part[1] * v;
}

// Of a step of `length`, over what a backward one keeps (B12).
double Kept(double x, double length) {
  return 1 + std::min(x / (1 + 4 * x), length < 1 ? (1 - length) / std::max(length, 1e-20) : 0.0);
}

}  // namespace

ReferenceHair Begin(std::span<const Vector3d> directions, std::span<const Vector3d> steps) {
  ReferenceHair hair;
  for (size_t i = 0; i < directions.size(); ++i) {
    const Vector3d e = directions[i].normalized();
    const double t = std::acos(e.y()), f = std::atan2(e.x(), e.z());
    hair.e.push_back(e);
    hair.step.push_back(Across(steps[i], e));
    hair.angles.push_back({t, f, steps[i].dot(U(t, f)), steps[i].dot(V(f)) / std::sin(t)});
  }
  return hair;
}

std::vector<Vector3d> StepsOf(const MotionSettings& settings, const ReferenceHair& state) {
  if (settings.equations == Equations::kAcross) return state.step;
  std::vector<Vector3d> steps;
  for (const auto& [t, f, t_step, f_step] : state.angles) {
    steps.push_back(t_step * U(t, f) + f_step * std::sin(t) * V(f));
  }
  return steps;
}

void ReferenceStep(const MotionHair& hair, int index, const Vector3d& gravity,
                   const MotionSettings& settings, const MotionDrive& drive, const Vector3d& wind,
                   const std::optional<Hull>& hull, ReferenceHair* state) {
  const bool polar = settings.equations == Equations::kPolar;
  const double dt = drive.duration;
  const double dt_before = drive.duration_before > 0 ? drive.duration_before : dt;
  const double beta = drive.drag_scale * hair.drag, tau = drive.friction_scale * hair.friction;
  const Matrix3d R = drive.head.q.toRotationMatrix();
  const Vector3d w = dt * drive.spin;
  const auto back = [](const Vector3d& turn) {
    return math::FromRotationVector(-turn).toRotationMatrix();
  };
  const Vector3d arm = back(w / 2) * R * hair.root;
  const Vector3d arm_before = back(dt_before / 2 * drive.spin_before) * back(w) * R * hair.root;
  const Vector3d velocity = drive.velocity + drive.spin.cross(arm);
  const Vector3d velocity_before = drive.velocity_before + drive.spin_before.cross(arm_before);
  const Vector3d g = drive.gravity - (velocity - velocity_before) / dt + beta * (wind - velocity);

  Vector3d p_begin = hair.root, p = hair.root, previous;  // Head frame.
  for (size_t i = 0; i < hair.rest.size(); ++i) {
    const Vector3d rest = R * hair.rest[i];
    ReferenceHair::Angles& at = state->angles[i];
    Vector3d& delta = state->step[i];
    Vector3d from = polar ? E(at.t, at.f) : state->e[i], e;
    delta *= dt / dt_before, at.t_step *= dt / dt_before, at.f_step *= dt / dt_before;
    p_begin += hair.segment_length * (R.transpose() * from);

    Vector3d F = R * (hair.hold[i] * hair.rest[i] - gravity) + g;
    if (hull && !settings.epsilon.empty()) {
      const Vector3d D = R * hull->Gradient(p_begin);
      if (D.dot(F) < settings.alpha * D.norm() * F.norm() &&
          hull->At(p_begin) < settings.near * D.norm()) {
        F *= static_cast<double>(settings.epsilon[i]);
      }
    }
    const double push = dt * dt * hair.response[i], f = hair.response[i] * hair.hold[i] * tau * dt;
    const double x = settings.bounded ? push * F.norm() : 0;
    const auto set = [&](const Vector3d& to) {
      const bool turned = V(at.f).cross(Vector3d::UnitY()).dot(to) < 0;  // Away from the azimuth.
      const double level = std::hypot(to.x(), to.z()) * (turned ? -1 : 1);
      at.t = std::atan2(level, to.y());
      at.f = std::atan2(to.x() / level, to.z() / level);
    };
    const bool clamped = settings.clamped && i == 0;
    bool corrected = clamped, inside = false;
    double speed = 0;
    if (clamped) {
      e = rest;
    } else {
      // B9, B12.
      if (polar) {
        const Vector3d level(F.x(), 0, F.z());
        if (std::abs(std::sin(at.t)) < 1e-4 && level.norm() > 1e-4 * F.norm()) {
          const double kept = level.normalized().dot(Vector3d(std::sin(at.f), 0, std::cos(at.f)));
          at = {kept < 0 ? -at.t : at.t, std::atan2(F.x(), F.z()), kept * at.t_step, 0};
        }
        const double s = std::sin(at.t);
        const Vector3d rides = w.cross(E(at.t, at.f)), u = U(at.t, at.f), v = V(at.f);
        at.t_step =
            (Kept(x, std::abs(at.t_step)) * at.t_step + push * F.dot(u) + f * rides.dot(u)) /
            (1 + beta * dt + f + x);
        at.f_step = (Kept(std::abs(s) * x, std::abs(at.f_step)) * at.f_step + s * push * F.dot(v) +
                     s * f * rides.dot(v)) /
                    (1 + beta * dt + s * s * f + std::abs(s) * x);
        at.t = Wrap(at.t + at.t_step);
        at.f = Wrap(at.f + at.f_step);
        e = E(at.t, at.f);
      } else {
        delta = (Kept(x, delta.norm()) * delta + push * Across(F, from) + f * w.cross(from)) /
                (1 + beta * dt + f + x);
        const Matrix3d turn = Turn(from, delta);
        e = turn * from;
        delta = turn * delta;
      }
      // B15.
      if (settings.fluctuation > 0 && drive.frame % 10 == 0) {
        const Vector3d before = e;
        const Matrix3d turn = Turn(e, Drawn(settings, drive.frame, index, static_cast<int>(i), e));
        e = turn * e;
        delta = turn * delta;
        from = (from + (e - before)).normalized();
        set(e);
      }
      // B14.
      if (i > 0 && !settings.largest_turn.empty()) {
        const double most = settings.largest_turn[i];
        if (Angle(previous, e) > most) {
          const Vector3d b = Across(e, previous).normalized();
          e = std::cos(most) * previous + std::sin(most) * b;
          corrected = true;
        }
      }
      // B6.
      if (hull && settings.avoid_hull) {
        const Vector3d local = R.transpose() * e;
        if (hull->At(p + hair.segment_length * local) < 0) {
          const Vector3d last =
              polar ? at.t_step * U(at.t, at.f) + at.f_step * std::sin(at.t) * V(at.f) : delta;
          speed = (last - w.cross(e)).norm();
          e = R * TurnedOut(*hull, p, hair.segment_length, local, local);
          corrected = inside = true;
        }
      }
    }
    if (corrected) {
      Vector3d went = Moved(from, e);
      if (inside) {
        const Vector3d end = p + hair.segment_length * (R.transpose() * e);
        const Vector3d n = Across(R * hull->Gradient(end), e).normalized();
        Vector3d past = went - w.cross(e);
        past -= std::min(0.0, past.dot(n)) * n;
        went = w.cross(e) + std::min(1.0, speed / past.norm()) * past;
      }
      delta = went;
      set(e);
      at.t_step = went.dot(U(at.t, at.f));
      at.f_step = std::clamp(went.dot(V(at.f)) / std::sin(at.t), -1.25, 1.25);
    }
    state->e[i] = e;
    p += hair.segment_length * (R.transpose() * e);
    previous = e;
  }
}

}  // namespace mane::beam::fixtures
