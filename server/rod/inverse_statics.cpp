#include "rod/inverse_statics.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "base/check.h"
#include "rod/chain.h"
#include "rod/energy.h"
#include "rod/hessian.h"
#include "rod/stays.h"

namespace mane::rod {

using Eigen::Vector3d;

namespace {

// Margins of stability (I3) that are tried in turn where stepping does not stay (I5).
constexpr double kMargins[] = {0.1, 0.2, 0.3, 0.4, 0.5, 0.7, 0.9};

// (I1): the natural curvatures that balance the weight at `theta`. Returns the largest change.
double Balance(Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
               std::span<const Vector3d> theta) {
  const int N = strand.elements();
  strand.natural.resize(N);
  for (int Q = 0; Q < N; ++Q) strand.natural[Q] = theta[Q] / strand.length[Q];
  std::vector<Vector3d> unbalanced(N);  // Without elastic moments, this is the weight's.
  PotentialGradient(strand, clamp, gravity, theta, unbalanced);
  double largest = 0;
  for (int Q = 0; Q < N; ++Q) {
    const Vector3d change = unbalanced[Q].cwiseQuotient(strand.stiffness);
    strand.natural[Q] += change;
    largest = std::max(largest, change.norm());
  }
  return largest;
}

// Settles from `start` and compares the element ends with the wanted ones.
void Settle(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
            std::span<const Vector3d> theta, std::vector<Vector3d>* start, HoldReport* report) {
  report->settling = SolveRestShape(strand, clamp, gravity, *start);
  const std::vector<ElementFrame> wanted = ElementFrames(strand, clamp, theta);
  const std::vector<ElementFrame> reached = ElementFrames(strand, clamp, *start);
  report->tip_deviation = (reached.back().r - wanted.back().r).norm();
  report->largest_deviation = 0;
  for (size_t Q = 0; Q < wanted.size(); ++Q) {
    report->largest_deviation =
        std::max(report->largest_deviation, (reached[Q].r - wanted[Q].r).norm());
  }
}

// (I5): the factors to try, from the one that statics tells.
std::vector<double> Factors(double statics, double weight, double largest) {
  std::vector<double> factors = {statics};
  if (statics < largest) factors.push_back(largest);
  for (const double margin : kMargins) {
    const double factor = -weight / (1 - margin);
    if (factor > statics && factor != largest) factors.push_back(factor);
  }
  std::sort(factors.begin(), factors.end());
  return factors;
}

// What came of leaving a strand alone, and where it then was [rad].
struct Left {
  StayReport stay{.stays = true};
  std::vector<Vector3d> theta;
};

// (I5): raises the factor of a shape that statics calls held until it stays. Fills in the factors
// and `held`, and returns what came of the factor applied.
Left Confirm(const Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
             std::span<const Vector3d> theta, const HoldOptions& options, double weight,
             HoldReport* report) {
  Left applied;
  const double statics = report->stiffness_factor;
  for (const double factor : Factors(statics, weight, options.max_stiffness_factor)) {
    Strand stiffened = strand;
    stiffened.stiffness *= factor;
    Balance(stiffened, clamp, gravity, theta);
    Left left{.theta = {theta.begin(), theta.end()}};
    left.stay = Stays(stiffened, clamp, gravity, options.longest_step, left.theta);
    if (factor > statics) report->needed_factor = factor;
    const bool stays = left.stay.stays;
    if (factor <= options.max_stiffness_factor) {
      report->stiffness_factor = factor;
      report->held = stays;
      applied = std::move(left);
    }
    if (stays) break;
  }
  return applied;
}

}  // namespace

HoldReport HoldShape(Strand& strand, const math::Pose& clamp, const Vector3d& gravity,
                     std::span<const Vector3d> theta, const HoldOptions& options,
                     std::span<Vector3d> rest) {
  const int N = strand.elements();
  MANE_CHECK(static_cast<int>(theta.size()) == N);
  MANE_CHECK(0 < options.min_stiffness_factor &&
             options.min_stiffness_factor <= options.max_stiffness_factor);
  MANE_CHECK(0 <= options.margin && options.margin < 1);

  HoldReport report;
  std::vector<Vector3d> mode(N);
  PotentialHessian hessian;
  hessian.Linearize(strand, clamp, gravity, theta);
  // Natural curvatures do not enter the Hessian: one eigenvalue tells every factor's (I3).
  const double weight = hessian.LowestEigenvalue(mode) - 1;
  report.needed_factor = std::max(0.0, -weight / (1 - options.margin));
  const double nominal =
      std::clamp(1.0, options.min_stiffness_factor, options.max_stiffness_factor);
  report.stiffness_factor = std::clamp(report.needed_factor, nominal, options.max_stiffness_factor);
  report.held = report.stiffness_factor >= report.needed_factor;
  Left left;
  if (report.held && options.longest_step > 0) {
    left = Confirm(strand, clamp, gravity, theta, options, weight, &report);
  }
  report.lowest_eigenvalue = 1 + weight / report.stiffness_factor;
  strand.stiffness *= report.stiffness_factor;
  report.natural_change = Balance(strand, clamp, gravity, theta);

  // To both sides along the softest mode, which a stiffness factor does not change.
  HoldReport other = report;
  std::vector<Vector3d> plus(N), minus(N);
  for (int Q = 0; Q < N; ++Q) {
    plus[Q] = theta[Q] + options.push * mode[Q];
    minus[Q] = theta[Q] - options.push * mode[Q];
  }
  if (!left.stay.stays) plus = minus = left.theta;
  Settle(strand, clamp, gravity, theta, &plus, &report);
  Settle(strand, clamp, gravity, theta, &minus, &other);
  if (other.largest_deviation > report.largest_deviation) {
    report = other;
    plus.swap(minus);
  }
  if (!left.stay.stays) {
    report.tip_deviation = std::max(report.tip_deviation, left.stay.tip);
    report.largest_deviation = std::max(report.largest_deviation, left.stay.farthest);
  }
  if (!rest.empty()) {
    MANE_CHECK(static_cast<int>(rest.size()) == N);
    std::copy(plus.begin(), plus.end(), rest.begin());
  }
  return report;
}

}  // namespace mane::rod
