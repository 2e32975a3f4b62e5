#pragma once

#include <string>
#include <vector>

#include "base/result.h"
#include "styling/style.h"

namespace mane::styling {

/// Standard normal distribution function.
[[nodiscard]] double NormalCdf(double x);

/// Its inverse to rounding; u in (0, 1), and -38 and 38 at and beyond the ends.
[[nodiscard]] double NormalQuantile(double u);

/// INVALID_ARGUMENT, naming the part of `field` that is at fault, unless every number drawn lies in
/// [low, high]: `mean` of kConstant; `low` <= `high` of the others, within the bounds; `mean` of
/// kNormal between its low and high (so that what is cut off is no more than what one draw in a few
/// would meet), `deviation` >= 0; 2 to 4096 finite `densities` >= 0, not all 0.
[[nodiscard]] Result<void> Validate(const Distribution& distribution, const std::string& field,
                                    double low, double high);

/// A valid distribution, made ready to draw from: x = quantile(u) with u uniform in [0, 1),
/// wisps.md (W18) to (W20). Immutable; reading is thread-safe and allocates nothing.
class Quantile {
 public:
  explicit Quantile(const Distribution& distribution);

  /// Inverse of Cdf; u in [0, 1]. Rises with u; within [low(), high()].
  [[nodiscard]] double operator()(double u) const;
  /// Probability of a number <= x; any x.
  [[nodiscard]] double Cdf(double x) const;
  [[nodiscard]] double Mean() const;

  [[nodiscard]] double low() const { return low_; }
  [[nodiscard]] double high() const { return high_; }

 private:
  double SampledQuantile(double u) const;
  double SampledCdf(double x) const;

  Distribution::Form form_;
  double low_, high_;
  double mean_ = 0, deviation_ = 0;  // Of kNormal.
  double below_ = 0, within_ = 1;    // Of kNormal: probabilities below low_, and up to high_.
  std::vector<double> density_;      // Of kSampled: integral 1 over [0, cells].
  std::vector<double> cumulative_;   // Of kSampled, at the same places.
};

}  // namespace mane::styling
