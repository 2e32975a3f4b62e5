#include "styling/outline.h"

#include <algorithm>
#include <cmath>

#include "styling/spline.h"

namespace mane::styling {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

// Tangents that deviate less than this from a linear course (rms, 0.6 degrees) are smooth: what
// repeats in them cannot be seen.
constexpr double kLeastWaviness = 0.01;
// A peak of the correlation counts from here on; pure noise and polynomials stay well below.
constexpr double kLeastPeak = 0.5;
// Of peaks this near to the highest the first is meant: the others are its multiples.
constexpr double kSamePeak = 0.1;
// A structure may take so much of the curve.
constexpr double kLargestLag = 0.6;
// Correlation that is lost within this part of the curve belongs to random turns, of which the
// curve then holds four or more; an arc's is lost later.
constexpr double kRandomLag = 1.0 / 16;

// What remains of unit tangents when each component's straight line of regression is taken away:
// a bend of the whole curve is no part of its pattern.
std::vector<Vector3d> Waves(std::span<const Vector3d> curve) {
  const int n = static_cast<int>(curve.size()) - 1;
  std::vector<Vector3d> f(n);
  for (int i = 0; i < n; ++i) f[i] = (curve[i + 1] - curve[i]).normalized();
  Vector3d mean = Vector3d::Zero(), slope = Vector3d::Zero();
  double square = 0;
  for (int i = 0; i < n; ++i) {
    const double x = i - 0.5 * (n - 1);
    mean += f[i] / n;
    slope += x * f[i];
    square += x * x;
  }
  slope /= square;
  for (int i = 0; i < n; ++i) f[i] -= mean + (i - 0.5 * (n - 1)) * slope;
  return f;
}

// (W4): correlation of f with itself for lags 0, 1, ..., each over the overlap and normalised
// there.
std::vector<double> Autocorrelation(std::span<const Vector3d> f) {
  const int n = static_cast<int>(f.size());
  std::vector<double> energy(n + 1, 0.0);  // Of the first i.
  for (int i = 0; i < n; ++i) energy[i + 1] = energy[i] + f[i].squaredNorm();
  std::vector<double> rho(static_cast<int>(kLargestLag * n) + 2);
  for (int lag = 0; lag < static_cast<int>(rho.size()); ++lag) {
    double sum = 0;
    for (int i = 0; i + lag < n; ++i) sum += f[i].dot(f[i + lag]);
    const double both = energy[n - lag] * (energy[n] - energy[lag]);
    rho[lag] = both > 0 ? sum / std::sqrt(both) : 0;
  }
  return rho;
}

// Lag of the first peak of rho behind `from` that is about as high as the highest; 0 without one.
double FirstHighPeak(std::span<const double> rho, int from) {
  const int end = static_cast<int>(rho.size()) - 1;
  const auto is_peak = [&](int i) { return rho[i] >= rho[i - 1] && rho[i] > rho[i + 1]; };
  double highest = 0;
  for (int i = from; i < end; ++i) {
    if (is_peak(i)) highest = std::max(highest, rho[i]);
  }
  if (highest < kLeastPeak) return 0;
  int peak = from;
  while (!is_peak(peak) || rho[peak] < highest - kSamePeak) ++peak;
  const double curvature = rho[peak - 1] - 2 * rho[peak] + rho[peak + 1];  // Of a parabola there.
  return peak + 0.5 * (rho[peak - 1] - rho[peak + 1]) / curvature;
}

// A sampled curve, linear between its samples.
class Sampled {
 public:
  explicit Sampled(std::span<const Vector3d> points) : points_(points) {
    integral_.resize(points.size(), Vector3d::Zero());
    for (size_t i = 1; i < points.size(); ++i) {
      integral_[i] = integral_[i - 1] + 0.5 * (points[i - 1] + points[i]);
    }
  }

  [[nodiscard]] int last() const { return static_cast<int>(points_.size()) - 1; }
  [[nodiscard]] Vector3d At(double x) const {
    const int i = std::clamp(static_cast<int>(x), 0, last() - 1);
    return points_[i] + (x - i) * (points_[i + 1] - points_[i]);
  }
  // (W3): mean over [x - width / 2, x + width / 2], continued straight on where that is too long.
  [[nodiscard]] Vector3d Mean(double x, double width) const {
    const double inside = std::clamp(x, 0.5 * width, last() - 0.5 * width);
    const double a = inside - 0.5 * width, b = inside + 0.5 * width;
    return (Integral(b) - Integral(a)) / width + (x - inside) * (At(b) - At(a)) / width;
  }

 private:
  [[nodiscard]] Vector3d Integral(double x) const {
    const int i = std::clamp(static_cast<int>(x), 0, last() - 1);
    const double t = x - i;
    return integral_[i] + t * points_[i] + 0.5 * t * t * (points_[i + 1] - points_[i]);
  }

  std::span<const Vector3d> points_;
  std::vector<Vector3d> integral_;
};

// Places on `axis`, in samples, that follow each other at exactly `step`.
std::vector<double> EqualSteps(const Sampled& axis, double step) {
  std::vector<double> places{0.0};
  Vector3d c = axis.At(0);
  for (int j = 0; j < axis.last();) {
    const Vector3d b = axis.At(j + 1);
    // At the very end rounding must not cost a segment.
    const double enough = j + 1 == axis.last() ? step * (1 - 1e-9) : step;
    if ((b - c).norm() < enough) {
      ++j;
      continue;
    }
    // Where a + t (b - a) leaves the sphere of radius `step` about c.
    const double x = std::max<double>(j, places.back());
    const Vector3d a = axis.At(x), d = b - a, o = a - c;
    const double half = o.dot(d), length2 = d.squaredNorm();
    const double root = half * half - length2 * (o.squaredNorm() - step * step);
    const double t = std::min(1.0, (std::sqrt(std::max(0.0, root)) - half) / length2);
    places.push_back(x + t * (j + 1 - x));
    c = axis.At(places.back());
    if (places.back() >= j + 1) ++j;
  }
  return places;
}

}  // namespace

double FindStructure(std::span<const Vector3d> curve) {
  const std::vector<Vector3d> f = Waves(curve);
  const double n = static_cast<double>(f.size());
  double energy = 0;
  for (const Vector3d& value : f) energy += value.squaredNorm() / n;
  if (!(energy > kLeastWaviness * kLeastWaviness)) return 0;
  const std::vector<double> rho = Autocorrelation(f);
  int lost = 1;
  while (lost + 1 < static_cast<int>(rho.size()) && rho[lost] > 0) ++lost;
  const double step = (curve[1] - curve[0]).norm();
  if (const double peak = FirstHighPeak(rho, lost); peak > 0) return peak * step;
  return lost <= kRandomLag * n ? 4 * lost * step : 0;  // (W5)
}

Decomposition Decompose(std::span<const Vector3d> curve, double segment_length,
                        std::optional<double> structure) {
  const int samples = std::clamp(4 * static_cast<int>(curve.size()), 1024, 4096);
  const std::vector<Vector3d> fine = Resample(curve, samples);
  const double length = Length(curve);
  double width = structure ? *structure : FindStructure(fine);
  if (!(width <= length)) width = 0;
  const double width_in_samples = width / length * (samples - 1);

  const Sampled points(fine);
  std::vector<Vector3d> means = fine;
  if (width > 0) {
    for (int i = 0; i < samples; ++i) means[i] = points.Mean(i, width_in_samples);
  }
  const Sampled axis(means);

  Decomposition result;
  result.structure = width * Length(means) / length;
  const std::vector<double> places = EqualSteps(axis, segment_length);
  for (double x : places) result.outline.push_back(axis.At(x));
  Vector3d direction = Vector3d::UnitX();
  Quaterniond frame = Quaterniond::Identity();
  for (size_t i = 0; i < places.size(); ++i) {
    if (i + 1 < places.size()) {
      const Vector3d next = (result.outline[i + 1] - result.outline[i]).normalized();
      frame = (Quaterniond::FromTwoVectors(direction, next) * frame).normalized();
      direction = next;
    }
    result.frames.push_back(frame);
    result.details.push_back(frame.conjugate() * (points.At(places[i]) - result.outline[i]));
  }
  return result;
}

}  // namespace mane::styling
