#include "rod/graded_lengths.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "base/check.h"

namespace mane::rod {
namespace {

constexpr double kGravity = 9.81;  // [m/s^2]

// Of the strand's length: the layer of hair too light to have one. It is near the best for the
// first natural frequency (L2).
constexpr double kThickestLayer = 0.5;
// Lengths grow so much from one end of a curled strand to the other (L3).
constexpr double kCurlGrowth = 4;
// Natural turn of a strand [rad] from which it counts as curled.
constexpr double kLeastCurl = 2 * std::numbers::pi;

// Where on [0, 1] a share W(s) = `share` of the elements is spent: W = s / 2 + (1 - exp(-s / e)) /
// (2 (1 - exp(-1 / e))) of L2. W rises and is concave, so that Newton's method from 0 stays below
// the root and rises to it.
double LayerPosition(double share, double e) {
  const double whole = -std::expm1(-1 / e);
  double s = 0;
  for (int i = 0; i < 100; ++i) {
    const double W = 0.5 * s - 0.5 * std::expm1(-s / e) / whole;
    const double density = 0.5 + 0.5 * std::exp(-s / e) / (e * whole);
    const double step = (share - W) / density;
    s += step;
    if (std::abs(step) < 1e-15) break;
  }
  return s;
}

// Ratio of neighbouring lengths.
double Growth(const Grading& grading, int N) {
  // Through 1.4 at N = 5, 1.2 at 8 and 1.15 at 10.
  if (grading.wound) return 1 + 0.4 * std::pow(5.0 / N, 1.4);
  return std::pow(kCurlGrowth, 1.0 / N);
}

}  // namespace

double GravitoBendingNumber(const Grading& grading) {
  const double L = grading.length;
  return grading.linear_density * kGravity * L * L * L / grading.stiffness;
}

std::vector<double> GradedLengths(const Grading& grading, int N) {
  MANE_CHECK(N >= 1 && grading.length > 0 && grading.stiffness > 0 && grading.linear_density > 0);
  std::vector<double> lengths(N);
  if (grading.wound || grading.curl * grading.length > kLeastCurl) {
    const double r = Growth(grading, N);
    for (int Q = 0; Q < N; ++Q) lengths[Q] = std::pow(r, Q);
  } else {
    const double e = std::min(1 / std::sqrt(GravitoBendingNumber(grading)), kThickestLayer);
    double left = 0;
    for (int Q = 0; Q < N; ++Q) {
      const double right = Q + 1 == N ? 1 : LayerPosition((Q + 1.0) / N, e);
      lengths[Q] = right - left;
      left = right;
    }
  }
  const double scale = grading.length / std::accumulate(lengths.begin(), lengths.end(), 0.0);
  for (double& l : lengths) l *= scale;
  return lengths;
}

}  // namespace mane::rod
