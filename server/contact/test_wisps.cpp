#include "contact/test_wisps.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <numbers>

#include "contact/test_segments.h"
#include "math/random.h"
#include "rod/scheme.h"

namespace mane::contact::fixtures {

using Eigen::Matrix3d;
using Eigen::Vector3d;

void Hair::AddGuide(float wisp_radius, float curly) {
  first.push_back(first.back());
  radius.push_back(wisp_radius);
  curliness.push_back(curly);
}

void Hair::AddPoint(const Vector3d& position, const Vector3d& velocity, double m) {
  x.push_back(static_cast<float>(position.x()));
  y.push_back(static_cast<float>(position.y()));
  z.push_back(static_cast<float>(position.z()));
  ux.push_back(static_cast<float>(velocity.x()));
  uy.push_back(static_cast<float>(velocity.y()));
  uz.push_back(static_cast<float>(velocity.z()));
  mass.push_back(static_cast<float>(m));
  ++first.back();
}

void Hair::RestHere() {
  rest_x = x;
  rest_y = y;
  rest_z = z;
}

WispPoints Hair::View() const {
  return {{x, y, z}, {ux, uy, uz}, mass, {rest_x, rest_y, rest_z}, first, radius, curliness};
}

Hair HeadOfHair(int guides, uint64_t seed) {
  constexpr double kScalp = 0.09;  // Radius [m].
  constexpr int kPoints = 30;
  constexpr double kStep = 0.012;
  math::RandomStream random(seed, 0);
  const double area = 2 * std::numbers::pi * kScalp * kScalp / guides;
  const auto wisp = static_cast<float>(1.2 * std::sqrt(area / std::numbers::pi));
  Hair hair;
  for (int g = 0; g < guides; ++g) {
    // Evenly over the upper half: equal steps of height, turned by the golden angle.
    const double height = (g + 0.5) / guides, turn = g * 2.399963229728653;
    const double out = std::sqrt(1 - height * height);
    const Vector3d normal(out * std::cos(turn), height, out * std::sin(turn));
    Vector3d x = kScalp * normal, tangent = normal;
    const Vector3d off(random.Normal(), random.Normal(), random.Normal());
    hair.AddGuide(wisp, static_cast<float>(random.Uniform()));
    for (int k = 0; k < kPoints; ++k) {
      hair.AddPoint(x, Vector3d::Zero(), 2e-6 * 1500 / guides);
      tangent = (tangent + Vector3d(0, -0.18, 0) + 0.01 * off).normalized();
      x += kStep * tangent;
    }
  }
  return hair;
}

void Shake(double speed, uint64_t seed, Hair* hair) {
  math::RandomStream random(seed, 1);
  for (std::vector<float>* u : {&hair->ux, &hair->uy, &hair->uz}) {
    for (float& v : *u) v = static_cast<float>(random.Uniform(-speed, speed));
  }
}

double CpuTime() {
  timespec time;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

Vector3d Impulses::Sum() const {
  Vector3d sum = Vector3d::Zero();
  for (size_t p = 0; p < x.size(); ++p) sum += At(p);
  return sum;
}

double Impulses::SumOfNorms() const {
  double sum = 0;
  for (size_t p = 0; p < x.size(); ++p) sum += At(p).norm();
  return sum;
}

void Tracking::Begin(const Hair& hair, double dt) {
  impulses = Impulses(hair.size());
  tracker.Begin(hair.View(), dt, scratch, pool, impulses.View());
}

void Tracking::Revise(const Hair& moving) {
  tracker.Revise({moving.ux, moving.uy, moving.uz}, scratch, pool, impulses.View());
}

std::span<const int32_t> Tracking::RevisePassing(const Hair& moving) {
  return tracker.RevisePassing({moving.ux, moving.uy, moving.uz}, scratch, pool, impulses.View());
}

WispSettings FromTheRoot() {
  WispSettings settings;
  settings.root_length = 0;
  return settings;
}

Hair Crossing(double height, double velocity) {
  Hair hair;
  hair.AddGuide(0.005f, 0);
  hair.AddPoint({-0.01, 0, 0}, Vector3d::Zero(), 1e-6);
  hair.AddPoint({0.01, 0, 0}, Vector3d::Zero(), 1e-6);
  hair.AddGuide(0.005f, 0);
  hair.AddPoint({0, height, -0.01}, {0, velocity, 0}, 1e-6);
  hair.AddPoint({0, height, 0.01}, {0, velocity, 0}, 1e-6);
  return hair;
}

void Rods::Add(const Vector3d& a, const Vector3d& b, int points, double mass, float radius,
               float curly, const Vector3d& velocity, bool rigid, const Vector3d& weight) {
  Rod rod{{}, {}, {}, mass / points, radius, curly, rigid, weight};
  for (int k = 0; k < points; ++k) {
    rod.x.emplace_back(a + (b - a) * k / (points - 1));
    rod.u.push_back(velocity);
    rod.momentary.push_back(velocity);
  }
  rods_.push_back(rod);
}

std::vector<Vector3d> Rods::Solve(const Rod& rod, const std::vector<Vector3d>& x,
                                  const std::vector<Vector3d>& free,
                                  const std::vector<Vector3d>& p) {
  const size_t n = x.size();
  std::vector<Vector3d> u(n);
  if (!rod.rigid) {
    for (size_t k = 0; k < n; ++k) u[k] = free[k] + p[k] / rod.m;
    return u;
  }
  Vector3d centre = Vector3d::Zero(), momentum = Vector3d::Zero(), spin = Vector3d::Zero();
  for (const Vector3d& y : x) centre += y / static_cast<double>(n);
  Matrix3d inertia = 1e-6 * static_cast<double>(n) * rod.m * Matrix3d::Identity();  // 1 mm thick.
  for (size_t k = 0; k < n; ++k) {
    const Vector3d r = x[k] - centre, q = rod.m * free[k] + p[k];
    momentum += q;
    spin += r.cross(q);
    inertia += rod.m * (r.squaredNorm() * Matrix3d::Identity() - r * r.transpose());
  }
  const Vector3d velocity = momentum / (static_cast<double>(n) * rod.m);
  const Vector3d omega = inertia.ldlt().solve(spin);
  for (size_t k = 0; k < n; ++k) u[k] = velocity + omega.cross(x[k] - centre);
  return u;
}

std::vector<Vector3d> Rods::Moved(const Rod& rod, double time) {
  std::vector<Vector3d> x(rod.x);
  if (!rod.rigid) {
    for (size_t k = 0; k < x.size(); ++k) x[k] += time * rod.u[k];
    return x;
  }
  Vector3d centre = Vector3d::Zero(), velocity = Vector3d::Zero();
  for (size_t k = 0; k < x.size(); ++k) {
    centre += x[k] / static_cast<double>(x.size());
    velocity += rod.u[k] / static_cast<double>(x.size());
  }
  // A straight rod's turn, across its axis.
  const Vector3d arm = x.back() - x.front();
  const Vector3d omega = arm.cross(rod.u.back() - rod.u.front()) / arm.squaredNorm();
  const double angle = time * omega.norm();
  const Matrix3d R =
      angle > 0 ? Matrix3d(Eigen::AngleAxisd(angle, omega.normalized())) : Matrix3d::Identity();
  for (Vector3d& y : x) y = centre + time * velocity + R * (y - centre);
  return x;
}

void Rods::Step(double dt) {
  Hair hair;
  std::vector<std::vector<Vector3d>> free, linear;
  for (const Rod& rod : rods_) {
    hair.AddGuide(rod.radius, rod.curly);
    linear.push_back(Moved(rod, rod::kTheta * dt));
    free.push_back(rod.momentary);
    for (size_t k = 0; k < rod.x.size(); ++k) {
      hair.AddPoint(linear.back()[k], rod.u[k], rod.m);
      free.back()[k] += (extrapolates ? rod::kTheta : 1) * dt * weight_scale * rod.weight;
    }
  }

  WispTracker& tracker = tracker_;
  if (tracker.pairs().empty()) tracker = WispTracker(settings);
  Impulses impulses(hair.size());
  tracker.Begin(hair.View(), dt, scratch_, *pool_, impulses.View());
  std::vector<std::vector<Vector3d>> u(rods_.size());
  for (int pass = 0; pass < passes + more_passes; ++pass) {
    Hair moved = hair;
    size_t at = 0;
    for (size_t i = 0; i < rods_.size(); ++i) {
      std::vector<Vector3d> p;
      for (size_t k = 0; k < rods_[i].x.size(); ++k) p.push_back(impulses.At(at + k));
      u[i] = Solve(rods_[i], linear[i], free[i], p);
      for (const Vector3d& v : u[i]) {
        moved.ux[at] = static_cast<float>(v.x());
        moved.uy[at] = static_cast<float>(v.y());
        moved.uz[at++] = static_cast<float>(v.z());
      }
    }
    const VelocitySpans velocities{moved.ux, moved.uy, moved.uz};
    if (pass + 1 < passes) {
      tracker.Revise(velocities, scratch_, *pool_, impulses.View());
    } else if (pass + 1 == passes + more_passes ||
               tracker.RevisePassing(velocities, scratch_, *pool_, impulses.View()).empty()) {
      break;
    }
  }

  for (size_t i = 0; i < rods_.size(); ++i) {
    rods_[i].u = u[i];
    for (size_t k = 0; k < u[i].size(); ++k) {
      Vector3d& v = rods_[i].momentary[k];
      v += (u[i][k] - v) / (extrapolates ? rod::kTheta : 1);
    }
  }
  const std::vector<Rod> begin = rods_;
  for (int k = 64; watch_ && k > 0; --k) {
    for (size_t i = 0; i < rods_.size(); ++i) rods_[i].x = Moved(begin[i], dt * k / 64);
    for (size_t i = 0; i < rods_.size(); ++i) {
      for (size_t j = i + 1; j < rods_.size(); ++j) {
        least_distance_ = std::min(least_distance_, Distance(i, j));
      }
    }
  }
  for (size_t i = 0; i < rods_.size(); ++i) rods_[i].x = Moved(begin[i], dt);
}

double Rods::Distance(size_t a, size_t b) const {
  const auto line = [&](size_t rod) {
    return Segment{rods_[rod].x.front().cast<float>(), rods_[rod].x.back().cast<float>()};
  };
  const ClosestFractions at = ClosestPoints(line(a), line(b));
  return (line(a).At(at.s) - line(b).At(at.t)).norm();
}

double Rods::KineticEnergy() const {
  double sum = 0;
  for (const Rod& rod : rods_) {
    for (const Vector3d& u : rod.momentary) sum += 0.5 * rod.m * u.squaredNorm();
  }
  return sum;
}

Vector3d Rods::Momentum() const {
  Vector3d sum = Vector3d::Zero();
  for (const Rod& rod : rods_) {
    for (const Vector3d& u : rod.momentary) sum += rod.m * u;
  }
  return sum;
}

Vector3d Rods::Centre(size_t rod) const {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& x : rods_[rod].x) sum += x;
  return sum / static_cast<double>(rods_[rod].x.size());
}

Vector3d Rods::MeanVelocity(size_t rod) const {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& u : rods_[rod].u) sum += u;
  return sum / static_cast<double>(rods_[rod].u.size());
}

void Rods::Shift(size_t rod, const Vector3d& by) {
  for (Vector3d& x : rods_[rod].x) x += by;
}

}  // namespace mane::contact::fixtures
