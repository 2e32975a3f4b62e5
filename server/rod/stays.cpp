#include "rod/stays.h"

#include <algorithm>
#include <random>
#include <vector>

#include "base/check.h"
#include "rod/chain.h"
#include "rod/step.h"

namespace mane::rod {

using Eigen::Vector3d;

namespace {

constexpr double kDuration = 8;         // [s]
constexpr double kPerturbation = 1e-6;  // Of an angle [rad].
constexpr double kFarthest = 1e-3;      // Of the length, that still counts as staying.

// Components within [-scale, scale].
Vector3d RandomVector(std::minstd_rand& random, double scale) {
  Vector3d v;
  for (double& component : v) {
    component = scale * (2.0 * static_cast<double>(random()) / std::minstd_rand::max() - 1);
  }
  return v;
}

// Largest distance of element ends.
double Farthest(const std::vector<ElementFrame>& a, const std::vector<ElementFrame>& b) {
  double farthest = 0;
  for (size_t Q = 0; Q < a.size(); ++Q) farthest = std::max(farthest, (a[Q].r - b[Q].r).norm());
  return farthest;
}

}  // namespace

StayReport Stays(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity, double dt,
                 std::span<Vector3d> theta) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N && dt > 0);
  const std::vector<ElementFrame> wanted = ElementFrames(strand, clamp, theta);
  std::minstd_rand random(1);
  for (Vector3d& angles : theta) angles += RandomVector(random, kPerturbation);
  std::vector<Vector3d> rate(N, Vector3d::Zero()), velocity(N * kGaussPoints, Vector3d::Zero());
  StepScratch scratch;
  StayReport report;
  double farthest[3] = {};  // In the first second, and in either half of what follows.
  const int steps = static_cast<int>(kDuration / dt);
  for (int i = 0; i < steps; ++i) {
    if (!Step(strand, {clamp, clamp, dt}, {.gravity = gravity}, {theta, rate, velocity}, scratch)) {
      return {false, strand.TotalLength(), strand.TotalLength()};
    }
    const double t = (i + 1) * dt;
    double& part = farthest[t <= kDuration / 4 ? 0 : t <= kDuration * 5 / 8 ? 1 : 2];
    const std::vector<ElementFrame> reached = ElementFrames(strand, clamp, theta);
    part = std::max(part, Farthest(wanted, reached));
    report.tip = std::max(report.tip, (reached.back().r - wanted.back().r).norm());
  }
  report.farthest = *std::ranges::max_element(farthest);
  report.stays = farthest[2] <= farthest[1] && report.farthest <= kFarthest * strand.TotalLength();
  return report;
}

}  // namespace mane::rod
