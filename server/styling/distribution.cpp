#include "styling/distribution.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "groom/range.h"

namespace mane::styling {
namespace {

using Form = Distribution::Form;

constexpr size_t kMostDensities = 4096;
constexpr double kFarthest = 38;  // The normal distribution function is 0 in double below -38.

double NormalDensity(double x) { return std::exp(-0.5 * x * x) / std::sqrt(2 * std::numbers::pi); }

// Acklam's rational approximations of the normal quantile, to 1.2e-9: of the middle, and of the
// lower tail.
double Middle(double u) {
  const double q = u - 0.5, r = q * q;
  return (((((-3.969683028665376e+01 * r + 2.209460984245205e+02) * r - 2.759285104469687e+02) * r +
            1.383577518672690e+02) *
               r -
           3.066479806614716e+01) *
              r +
          2.506628277459239e+00) *
         q /
         (((((-5.447609879822406e+01 * r + 1.615858368580409e+02) * r - 1.556989798598866e+02) * r +
            6.680131188771972e+01) *
               r -
           1.328068155288572e+01) *
              r +
          1);
}

double LowerTail(double u) {
  const double q = std::sqrt(-2 * std::log(u));
  return (((((-7.784894002430293e-03 * q - 3.223964580411365e-01) * q - 2.400758277161838e+00) * q -
            2.549732539343734e+00) *
               q +
           4.374664141464968e+00) *
              q +
          2.938163982698783e+00) /
         ((((7.784695709041462e-03 * q + 3.224671290700398e-01) * q + 2.445134137142996e+00) * q +
           3.754408661907416e+00) *
              q +
          1);
}

constexpr double kLeastDensity = 1e-100;  // Their integral must not vanish.

Result<void> ValidateDensities(const std::vector<double>& densities, const std::string& field) {
  if (densities.size() < 2 || densities.size() > kMostDensities) {
    return InvalidArgument(field, fmt::format("{} has {} densities; it must have 2 to {}", field,
                                              densities.size(), kMostDensities));
  }
  double largest = 0;
  for (size_t i = 0; i < densities.size(); ++i) {
    const groom::Range range{0, 1e12};
    if (!range.Contains(densities[i])) {
      return groom::OutOfRange(fmt::format("{}[{}]", field, i), densities[i], range);
    }
    largest = std::max(largest, densities[i]);
  }
  if (largest >= kLeastDensity) return {};
  return InvalidArgument(
      field, fmt::format("{} are all below {}; one must be more", field, kLeastDensity));
}

// As mane.v1.Distribution spells it.
const char* NameOf(Form form) {
  switch (form) {
    case Form::kConstant:
      return "constant";
    case Form::kUniform:
      return "uniform";
    case Form::kNormal:
      return "normal";
    case Form::kSampled:
      return "sampled";
  }
  return "form";
}

}  // namespace

double NormalCdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

double NormalQuantile(double u) {
  if (u > 0.5) return -NormalQuantile(1 - u);  // The lower half is where doubles are dense.
  if (!(u > 0)) return -kFarthest;
  const double x = u < 0.02425 ? LowerTail(u) : Middle(u);
  const double density = NormalDensity(x);
  if (density < 1e-300) return x;
  const double e = (NormalCdf(x) - u) / density;  // One step of Halley's method.
  return x - e / (1 + 0.5 * x * e);
}

Result<void> Validate(const Distribution& distribution, const std::string& field, double low,
                      double high) {
  const groom::Range bounds{low, high};
  if (distribution.form == Form::kConstant) {
    if (bounds.Contains(distribution.mean)) return {};
    return groom::OutOfRange(field + ".constant.value", distribution.mean, bounds);
  }
  const std::string path = fmt::format("{}.{}", field, NameOf(distribution.form));
  if (!bounds.Contains(distribution.low)) {
    return groom::OutOfRange(path + ".low", distribution.low, bounds);
  }
  const groom::Range above{distribution.low, high};
  if (!above.Contains(distribution.high)) {
    return groom::OutOfRange(path + ".high", distribution.high, above);
  }
  if (distribution.form == Form::kNormal) {
    const groom::Range between{distribution.low, distribution.high};
    if (!between.Contains(distribution.mean)) {
      return groom::OutOfRange(path + ".mean", distribution.mean, between);
    }
    const groom::Range deviations{0, 1e6};
    if (!deviations.Contains(distribution.deviation)) {
      return groom::OutOfRange(path + ".deviation", distribution.deviation, deviations);
    }
  }
  if (distribution.form == Form::kSampled) {
    return ValidateDensities(distribution.densities, path + ".densities");
  }
  return {};
}

Quantile::Quantile(const Distribution& distribution)
    : form_(distribution.form), low_(distribution.low), high_(distribution.high) {
  // What cannot vary is a constant.
  const bool fixed = low_ == high_ || (form_ == Form::kNormal && distribution.deviation == 0);
  if (form_ == Form::kConstant || fixed) {
    low_ = high_ = form_ == Form::kConstant || form_ == Form::kNormal ? distribution.mean : low_;
    form_ = Form::kConstant;
  } else if (form_ == Form::kNormal) {
    mean_ = distribution.mean;
    deviation_ = distribution.deviation;
    below_ = NormalCdf((low_ - mean_) / deviation_);
    within_ = NormalCdf((high_ - mean_) / deviation_) - below_;
  } else if (form_ == Form::kSampled) {
    density_ = distribution.densities;
    cumulative_.assign(density_.size(), 0);
    for (size_t i = 1; i < density_.size(); ++i) {
      cumulative_[i] = cumulative_[i - 1] + 0.5 * (density_[i - 1] + density_[i]);
    }
    const double total = cumulative_.back();
    for (double& density : density_) density /= total;
    for (double& cumulative : cumulative_) cumulative /= total;
  }
}

double Quantile::operator()(double u) const {
  switch (form_) {
    case Form::kConstant:
      return low_;
    case Form::kUniform:
      return low_ + u * (high_ - low_);
    case Form::kNormal:  // (W19)
      return std::clamp(mean_ + deviation_ * NormalQuantile(below_ + u * within_), low_, high_);
    case Form::kSampled:
      return SampledQuantile(u);
  }
  return low_;
}

double Quantile::SampledQuantile(double u) const {
  const auto above = std::upper_bound(cumulative_.begin(), cumulative_.end(), u);
  const auto cells = static_cast<int>(density_.size()) - 1;
  const int i = std::clamp(static_cast<int>(above - cumulative_.begin()) - 1, 0, cells - 1);
  const double f = density_[i], df = density_[i + 1] - f, rest = u - cumulative_[i];
  // (W20): f t + df t^2 / 2 = rest, in the form that cancels nowhere.
  const double divisor = f + std::sqrt(std::max(0.0, f * f + 2 * df * rest));
  const double t = divisor > 0 ? std::min(1.0, 2 * rest / divisor) : 0;
  return low_ + (high_ - low_) * (i + t) / cells;
}

double Quantile::Cdf(double x) const {
  if (x >= high_) return 1;
  if (x < low_) return 0;
  switch (form_) {
    case Form::kUniform:
      return (x - low_) / (high_ - low_);
    case Form::kNormal:
      return (NormalCdf((x - mean_) / deviation_) - below_) / within_;
    case Form::kSampled:
      return SampledCdf(x);
    case Form::kConstant:
      break;
  }
  return 0;
}

double Quantile::SampledCdf(double x) const {
  const auto cells = static_cast<int>(density_.size()) - 1;
  const double at = (x - low_) / (high_ - low_) * cells;
  const int i = std::clamp(static_cast<int>(at), 0, cells - 1);
  const double t = at - i;
  return cumulative_[i] + t * density_[i] + 0.5 * t * t * (density_[i + 1] - density_[i]);
}

double Quantile::Mean() const {
  if (form_ == Form::kNormal) {
    const double a = (low_ - mean_) / deviation_, b = (high_ - mean_) / deviation_;
    return mean_ + deviation_ * (NormalDensity(a) - NormalDensity(b)) / within_;
  }
  if (form_ != Form::kSampled) return 0.5 * (low_ + high_);
  double mean = 0;  // Of the cell's number and the place in it.
  for (size_t i = 0; i + 1 < density_.size(); ++i) {
    mean += 0.5 * static_cast<double>(i) * (density_[i] + density_[i + 1]) +
            (density_[i] + 2 * density_[i + 1]) / 6;
  }
  return low_ + (high_ - low_) * mean / static_cast<double>(density_.size() - 1);
}

}  // namespace mane::styling
