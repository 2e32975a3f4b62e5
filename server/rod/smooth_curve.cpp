#include "rod/smooth_curve.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/check.h"
#include "rod/scheme.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;

// Too few points for cross-validation to tell noise from shape.
constexpr size_t kLeastSmoothed = 10;

// Symmetric pentadiagonal matrix: row i holds (i, i), (i, i + 1), (i, i + 2).
using Band = std::vector<std::array<double, 3>>;

// Penalty int |x''|^2 over uneven steps, by second divided differences.
Band Roughness(std::span<const Vector3d> x) {
  const size_t n = x.size();
  Band P(n, {0, 0, 0});
  for (size_t i = 1; i + 1 < n; ++i) {
    const double a = (x[i] - x[i - 1]).norm(), b = (x[i + 1] - x[i]).norm(), c = 0.5 * (a + b);
    const double root = std::sqrt(c);
    const std::array<double, 3> d = {root / (a * c), -root * (1 / a + 1 / b) / c, root / (b * c)};
    for (size_t j = 0; j < 3; ++j) {
      for (size_t k = j; k < 3; ++k) P[i - 1 + j][k - j] += d[j] * d[k];
    }
  }
  return P;
}

// (1 + lambda P)^-1 applied to the points, and the inverse's trace.
struct Smoothed {
  std::vector<Vector3d> x;
  double trace;
  double residual;  // Sum of squared moves.
};

Smoothed Apply(const Band& P, double lambda, std::span<const Vector3d> points) {
  const size_t n = points.size();
  std::vector<double> d(n), l1(n, 0), l2(n, 0);  // L D L^T; l1[i] = L(i+1, i), l2[i] = L(i+2, i).
  for (size_t i = 0; i < n; ++i) {
    double diagonal = 1 + lambda * P[i][0], next = lambda * P[i][1];
    if (i >= 1) {
      diagonal -= l1[i - 1] * l1[i - 1] * d[i - 1];
      next -= l2[i - 1] * l1[i - 1] * d[i - 1];
    }
    if (i >= 2) diagonal -= l2[i - 2] * l2[i - 2] * d[i - 2];
    d[i] = diagonal;
    if (i + 1 < n) l1[i] = next / diagonal;
    if (i + 2 < n) l2[i] = lambda * P[i][2] / diagonal;
  }
  Smoothed out{{points.begin(), points.end()}, 0, 0};
  for (size_t i = 0; i < n; ++i) {
    if (i >= 1) out.x[i] -= l1[i - 1] * out.x[i - 1];
    if (i >= 2) out.x[i] -= l2[i - 2] * out.x[i - 2];
  }
  // Backwards the solution, and the band of the inverse (Takahashi's recurrence; Hutchinson and de
  // Hoog 1985): z0[i], z1[i] are its entries (i, i), (i, i + 1).
  std::vector<double> z0(n, 0), z1(n, 0);
  for (size_t i = n; i-- > 0;) {
    out.x[i] /= d[i];
    double zi1 = 0, zi2 = 0;
    if (i + 1 < n) {
      out.x[i] -= l1[i] * out.x[i + 1];
      zi1 -= l1[i] * z0[i + 1];
    }
    if (i + 2 < n) {
      out.x[i] -= l2[i] * out.x[i + 2];
      zi1 -= l2[i] * z1[i + 1];
      zi2 = -l1[i] * z1[i + 1] - l2[i] * z0[i + 2];
    }
    z0[i] = 1 / d[i] - l1[i] * zi1 - l2[i] * zi2;
    z1[i] = zi1;
    out.trace += z0[i];
    out.residual += (out.x[i] - points[i]).squaredNorm();
  }
  return out;
}

// Derivative at t[0] of the polynomial through up to four points.
Vector3d EndSlope(std::span<const double> t, std::span<const Vector3d> x) {
  Vector3d slope = Vector3d::Zero();
  for (size_t j = 1; j < t.size(); ++j) {
    double weight = 1 / (t[j] - t[0]);
    for (size_t k = 1; k < t.size(); ++k) {
      if (k != j) weight *= (t[0] - t[k]) / (t[j] - t[k]);
    }
    slope += weight * (x[j] - x[0]);
  }
  return slope;
}

}  // namespace

SmoothCurve::SmoothCurve(std::span<const Vector3d> points, double noise)
    : noise_(noise), point_(points.begin(), points.end()) {
  MANE_CHECK(points.size() >= 2);
  Smooth();
  Interpolate();
}

void SmoothCurve::Smooth() {
  const double n = static_cast<double>(point_.size());
  if (noise_ == 0 || point_.size() < kLeastSmoothed) {
    noise_ = std::max(noise_, 0.0);
    return;
  }
  const Band P = Roughness(point_);
  Smoothed best{point_, n, 0};
  double least = -1, estimate = 0;
  for (double exponent = -12; exponent <= 0; exponent += 0.25) {
    Smoothed trial = Apply(P, std::pow(10, exponent), point_);
    const double freedom = std::max(n - trial.trace, 1e-9 * n);
    if (noise_ > 0) {  // The smoothest that the given noise explains.
      if (trial.residual > 3 * n * noise_ * noise_) break;
      best = std::move(trial);
      continue;
    }
    const double score = trial.residual / (freedom * freedom);
    if (least < 0 || score < least) {
      least = score;
      estimate = std::sqrt(trial.residual / (3 * freedom));
      best = std::move(trial);
    }
  }
  if (noise_ < 0) noise_ = estimate;
  point_ = std::move(best.x);
}

// Cubic spline over the chord length, its end slopes those of the cubics through four points.
void SmoothCurve::Interpolate() {
  std::vector<Vector3d> x;  // Smoothing may have made neighbours meet: keep the steps positive.
  knot_.assign(1, 0.0);
  const size_t n = point_.size();
  for (size_t i = 1; i < n; ++i) {
    knot_.push_back(knot_.back() + std::max((point_[i] - point_[i - 1]).norm(), 1e-12));
  }
  const size_t m = std::min<size_t>(n, 4);
  slope_.assign(n, Vector3d::Zero());
  slope_[0] = EndSlope(std::span(knot_).first(m), std::span(point_).first(m));
  std::vector<double> t(knot_.rbegin(), knot_.rbegin() + static_cast<long>(m));
  x.assign(point_.rbegin(), point_.rbegin() + static_cast<long>(m));
  slope_[n - 1] = EndSlope(t, x);
  // Uneven steps can make the end cubics swing; a slope over the chord is about one.
  for (Vector3d* slope : {&slope_[0], &slope_[n - 1]}) {
    if (slope->norm() > 2) *slope *= 2 / slope->norm();
  }
  // Continuous second derivatives: b m_{i-1} + 2 (a + b) m_i + a m_{i+1} = 3 (b d_a + a d_b) for
  // steps a, b to either side and their difference quotients.
  std::vector<double> upper(n, 0);
  for (size_t i = 1; i + 1 < n; ++i) {
    const double a = knot_[i] - knot_[i - 1], b = knot_[i + 1] - knot_[i];
    const Vector3d right =
        3 * (b / a * (point_[i] - point_[i - 1]) + a / b * (point_[i + 1] - point_[i]));
    const double pivot = 2 * (a + b) - b * upper[i - 1];
    upper[i] = a / pivot;
    slope_[i] = (right - b * slope_[i - 1]) / pivot;
  }
  for (size_t i = n - 1; i-- > 1;) slope_[i] -= upper[i] * slope_[i + 1];
  arc_.assign(1, 0.0);
  for (size_t i = 0; i + 1 < n; ++i) {
    arc_.push_back(arc_.back() + std::max(ArcWithin(static_cast<int>(i), 1), 1e-12));
  }
}

Vector3d SmoothCurve::Position(Location at) const {
  const int i = at.segment;
  const double h = knot_[i + 1] - knot_[i], u = at.u, v = 1 - u;
  return v * v * ((1 + 2 * u) * point_[i] + u * h * slope_[i]) +
         u * u * ((1 + 2 * v) * point_[i + 1] - v * h * slope_[i + 1]);
}

// By u, over the segment.
Vector3d SmoothCurve::Derivative(Location at) const {
  const int i = at.segment;
  const double h = knot_[i + 1] - knot_[i], u = at.u, v = 1 - u;
  return 6 * u * v * (point_[i + 1] - point_[i]) + v * (1 - 3 * u) * h * slope_[i] +
         u * (3 * u - 2) * h * slope_[i + 1];
}

double SmoothCurve::ArcWithin(int segment, double u) const {
  double arc = 0;
  for (int g = 0; g < kBeads; ++g) {
    arc += kBeadRule.weights[g] * u * Derivative({segment, kBeadRule.nodes[g] * u}).norm();
  }
  return arc;
}

SmoothCurve::Location SmoothCurve::Locate(double s) const {
  const auto after = std::upper_bound(arc_.begin() + 1, arc_.end() - 1, s);
  const int i = static_cast<int>(after - arc_.begin()) - 1;
  const double wanted = s - arc_[i], all = arc_[i + 1] - arc_[i];
  double u = std::clamp(wanted / all, 0.0, 1.0);
  for (int k = 0; k < 4; ++k) {
    const double speed = std::max(Derivative({i, u}).norm(), 0.1 * all);
    u = std::clamp(u - (ArcWithin(i, u) - wanted) / speed, 0.0, 1.0);
  }
  return {i, u};
}

Vector3d SmoothCurve::At(double s) const { return Position(Locate(s)); }

Vector3d SmoothCurve::Tangent(double s) const {
  const Location at = Locate(s);
  const Vector3d d = Derivative(at);
  if (d.norm() > 1e-6 * (knot_[at.segment + 1] - knot_[at.segment])) return d.normalized();
  // A cusp, where the polyline turns back.
  const Vector3d chord = point_[at.segment + 1] - point_[at.segment];
  return chord.norm() > 0 ? Vector3d(chord.normalized()) : Vector3d(Vector3d::UnitX());
}

}  // namespace mane::rod
