#include "groom/resolution.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "groom/presets.h"
#include "math/rigid.h"
#include "rod/chain.h"
#include "rod/statics.h"
#include "rod/wound.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// What was measured (rod.md, Number of elements): N^2 times the error of graded straight hair is at
// most this, and the error of curled hair in motion is at most so many times that at rest.
constexpr double kStraightError = 0.55;
constexpr double kMotionOverRest = 1.8;
// Wound hair of 5 elements is within kWoundError up to this CoilWeight, of 10 wherever weight lets
// it be wound (coil.md, Which strands).
constexpr double kCoarseCoilWeight = 0.18;
constexpr int kFewestWound = 5, kMostWound = 10;

// Elements of the strand that stands for the converged one.
constexpr int kReference = 64;
// Fewer elements a turn than these cannot bend the axis of a coil, wherever it happens to rest.
constexpr double kElementsPerTurn = 2;

// Roots all around: n0 from nearly straight down to steeply up, each rolled its own way.
std::array<math::Pose, 6> Roots() {
  constexpr std::array<double, 6> elevation{0, 0.5, -0.8, 0.2, 0.9, -1.3},
      roll{0, 1, 2.5, 4, 5, 0.5};
  std::array<math::Pose, 6> roots;
  for (size_t i = 0; i < roots.size(); ++i) {
    roots[i].q = Eigen::AngleAxisd(elevation[i], Vector3d::UnitZ()) *
                 Eigen::AngleAxisd(roll[i], Vector3d::UnitX());
  }
  return roots;
}

using Tips = std::array<Vector3d, 6>;

Tips RestingTips(HairType type, double length, int N) {
  const rod::Strand strand = PresetStrand(type, length, N);
  const std::array<math::Pose, 6> roots = Roots();
  Tips tips;
  for (size_t i = 0; i < roots.size(); ++i) {
    std::vector<Vector3d> theta(N);
    for (int Q = 0; Q < N; ++Q) theta[Q] = strand.length[Q] * strand.natural[Q];
    (void)rod::SolveRestShape(strand, roots[i], {0, -9.81, 0}, theta);
    tips[i] = rod::ElementFrames(strand, roots[i], theta).back().r;
  }
  return tips;
}

double Distance(const Tips& a, const Tips& b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(a.size()));
}

double Turns(HairType type, double length) {
  return NaturalCurvature(PresetOf(type)).norm() * length / (2 * pi);
}

int StraightElements(double target) {
  const double N = std::ceil(std::sqrt(kStraightError / target));
  return static_cast<int>(std::clamp<double>(N, kFewestElements, kMostElements));
}

}  // namespace

bool IsResolved(HairType type, double length) {
  return kElementsPerTurn * Turns(type, length) < kMostElements;
}

rod::Grading GradingOf(HairType type, double length, bool wound) {
  const Preset preset = PresetOf(type);
  return {.length = length,
          .stiffness = rod::Stiffness(preset.section, preset.material).tail<2>().minCoeff(),
          .linear_density = rod::LinearDensity(preset.section, preset.material),
          .curl = NaturalCurvature(preset).norm(),
          .wound = wound};
}

rod::Strand PresetStrand(HairType type, double length, int N) {
  const Preset preset = PresetOf(type);
  rod::Strand strand;
  strand.length = rod::GradedLengths(GradingOf(type, length, false), N);
  strand.natural.assign(N, NaturalCurvature(preset));
  strand.stiffness = rod::Stiffness(preset.section, preset.material);
  strand.linear_density = rod::LinearDensity(preset.section, preset.material);
  strand.internal_friction = preset.internal_friction;
  strand.air_drag = preset.air_drag;
  return strand;
}

int ElementCountFor(HairType type, double length, double target, bool wound) {
  if (wound) {
    const bool light =
        rod::CoilWeight(PresetStrand(type, length, kFewestWound)) <= kCoarseCoilWeight;
    return target >= kWoundError && light ? kFewestWound : kMostWound;
  }
  const double turns = Turns(type, length);
  if (turns == 0) return StraightElements(target);
  if (!IsResolved(type, length)) return kMostElements;
  const double fewest = std::max<double>(kFewestElements, std::ceil(kElementsPerTurn * turns));
  const Tips converged = RestingTips(type, length, kReference);
  for (int N = static_cast<int>(fewest); N < kMostElements; ++N) {
    const double error = Distance(RestingTips(type, length, N), converged) / length;
    if (kMotionOverRest * error <= target) return N;
  }
  return kMostElements;
}

}  // namespace mane::groom
