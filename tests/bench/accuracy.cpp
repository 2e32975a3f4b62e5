// Measures how near the Super-Helix of few elements comes to the converged rod, with the element
// lengths that generated hair has, and float32 to double precision. Prints one JSON object; all
// distances are of the tip, relative to the length.

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <string>
#include <vector>

#include "rod/chain.h"
#include "rod/graded_lengths.h"
#include "rod/statics.h"
#include "rod/test_batches.h"
#include "rod/test_shake.h"
#include "simd/isa.h"

namespace mane::rod {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using fixtures::State;

constexpr int kConverged = 160;
const Vector3d kGravity(0, -9.81, 0);

// `one`, a strand of one element, cut into N elements.
Strand Cut(const Strand& one, int N, bool graded) {
  const Grading grading{.length = one.TotalLength(),
                        .stiffness = one.stiffness.tail<2>().minCoeff(),
                        .linear_density = one.linear_density,
                        .curl = one.natural[0].norm()};
  Strand strand = one;
  strand.length = GradedLengths(grading, N);
  if (!graded) strand.length.assign(N, one.TotalLength() / N);
  strand.natural.assign(N, one.natural[0]);
  return strand;
}

Vector3d RestingTip(const Strand& strand, const math::Pose& root) {
  return fixtures::TipOf(strand, root, fixtures::AtRest(strand, root).theta);
}

// Smooth hair of 20 cm, clamped horizontally.
double StaticError(int N, bool graded) {
  const Strand one = fixtures::HeavyStrand(163.24, 1);
  return (RestingTip(Cut(one, N, graded), {}) - RestingTip(Cut(one, 2 * kConverged, true), {}))
             .norm() /
         one.TotalLength();
}

// First natural frequency of a straight cantilever without weight, against that of the beam.
double FrequencyError(int N, bool graded) {
  const Strand strand = Cut(fixtures::HeavyStrand(1e-3, 1), N, graded);
  const MatrixXd full = fixtures::StepMassMatrix(strand, {}, State(strand).theta);
  MatrixXd M(N, N), K = MatrixXd::Zero(N, N);
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) M(i, j) = full(3 * i + 1, 3 * j + 1);
    K(i, i) = strand.stiffness[1] / strand.length[i];
  }
  const double omega =
      std::sqrt(Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd>(K, M).eigenvalues()[0]);
  const double root = 1.8751040687119611;  // Of cosh x cos x = -1.
  return omega / (root * root *
                  std::sqrt(strand.stiffness[1] / strand.linear_density /
                            std::pow(strand.TotalLength(), 4))) -
         1;
}

// Largest error of a rod that bends and twists: naturally an arc of `turn` rad in the horizontal
// plane at the clamp, which weight draws out of it, and in the vertical plane, bent up, out of
// which it falls; a natural twist of a hundredth of the turn decides to which side.
double BendTwistError(int N) {
  double worst = 0;
  for (const double number : {5.0, 20.0, 60.0, 163.24}) {
    for (const double turn : {0.5, 1.5, 3.0, 6.0}) {
      for (const double roll : {M_PI / 2, M_PI}) {
        Strand one = fixtures::HeavyStrand(number, 1);
        const double L = one.TotalLength();
        one.natural[0] = Vector3d(0.01, 1, 0) * turn / L;
        const math::Pose root{Vector3d::Zero(),
                              Eigen::Quaterniond(Eigen::AngleAxisd(roll, Vector3d::UnitX()))};
        const double error =
            (RestingTip(Cut(one, N, true), root) - RestingTip(Cut(one, kConverged, true), root))
                .norm() /
            L;
        worst = std::max(worst, error);
      }
    }
  }
  return worst;
}

// Rms distance over the roots between a shaken strand and the converged one.
double ShakeError(const Strand& one, int N, bool graded) {
  double squares = 0;
  for (const math::Pose& root : fixtures::SideRoots()) {
    const double error = fixtures::RmsDistance(fixtures::ShakenTips(Cut(one, N, graded), root),
                                               fixtures::ShakenTips(Cut(one, 80, true), root));
    squares += error * error / 6;
  }
  return std::sqrt(squares) / one.TotalLength();
}

// The batched float32 step against the double-precision one over two seconds of the shake at 60 Hz,
// all roots.
double FloatError(const Strand& strand) {
  constexpr double kDt = 1.0 / 60;
  const std::vector<math::Pose> roots = fixtures::SideRoots();
  fixtures::Packed<float> packed;
  std::vector<State> states;
  for (const math::Pose& root : roots) {
    states.push_back(fixtures::AtRest(strand, root));
    packed.Add(strand, root, states.back());
  }
  packed.Pack();
  StepScratch scratch;
  double squares = 0;
  int count = 0;
  for (int i = 1; i <= 120; ++i) {
    const math::Pose begin = fixtures::ShakenHead((i - 1) * kDt),
                     end = fixtures::ShakenHead(i * kDt);
    (void)packed.Step(KernelsFor<float>(simd::Best()), {begin, end, kDt}, {});
    for (size_t k = 0; k < roots.size(); ++k) {
      (void)Step(strand, {begin * roots[k], end * roots[k], kDt}, {}, states[k].View(), scratch);
      squares += (fixtures::TipOf(strand, roots[k], packed.Get(static_cast<int>(k)).theta) -
                  fixtures::TipOf(strand, roots[k], states[k].theta))
                     .squaredNorm();
      ++count;
    }
  }
  return std::sqrt(squares / count) / strand.TotalLength();
}

// {"5": .., "10": ..} of `error`.
template <typename Error>
std::string ByElements(const Error& error) {
  return fmt::format("{{\"5\": {:.3g}, \"10\": {:.3g}}}", error(5), error(10));
}

int Main() {
  std::string shake, equal_shake, rounding;
  for (const fixtures::Hair& hair : fixtures::AppendixB()) {
    const Strand one = fixtures::MakeStrand(hair, 0.2, 1);
    const char* const comma = rounding.empty() ? "" : ", ";
    rounding += fmt::format("{}\"{}\": {}", comma, hair.name,
                            ByElements([&](int N) { return FloatError(Cut(one, N, true)); }));
    // Eighty elements do not resolve the coils of fuzzy hair.
    if (hair.name == "fuzzy") continue;
    shake += fmt::format("{}\"{}\": {}", comma, hair.name,
                         ByElements([&](int N) { return ShakeError(one, N, true); }));
    equal_shake += fmt::format("{}\"{}\": {}", comma, hair.name,
                               ByElements([&](int N) { return ShakeError(one, N, false); }));
  }
  fmt::print(
      "{{\"static_tip\": {}, \"static_tip_equal_lengths\": {}, \"first_frequency\": {}, "
      "\"first_frequency_equal_lengths\": {}, \"bend_twist\": {}, \"shake\": {{{}}}, "
      "\"shake_equal_lengths\": {{{}}}, \"float_over_double\": {{{}}}}}\n",
      ByElements([](int N) { return StaticError(N, true); }),
      ByElements([](int N) { return StaticError(N, false); }),
      ByElements([](int N) { return FrequencyError(N, true); }),
      ByElements([](int N) { return FrequencyError(N, false); }), ByElements(BendTwistError), shake,
      equal_shake, rounding);
  return 0;
}

}  // namespace
}  // namespace mane::rod

int main() { return mane::rod::Main(); }
