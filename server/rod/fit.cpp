#include "rod/fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/check.h"
#include "rod/fit_guess.h"
#include "rod/fitter.h"
#include "rod/smooth_curve.h"

namespace mane::rod {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSame = 1e-9;         // Of the whole: neighbours this close are one point.
constexpr double kLeastLength = 1e-6;  // m

// Where elements begin and end, in parts of the whole.
std::vector<double> Fractions(int elements, std::span<const double> proportions) {
  std::vector<double> fraction(elements + 1, 0);
  for (int Q = 0; Q < elements; ++Q) {
    fraction[Q + 1] = fraction[Q] + (proportions.empty() ? 1.0 : proportions[Q]);
  }
  const double whole = fraction.back();
  for (double& f : fraction) f /= whole;
  return fraction;
}

// The polyline in units of its size, from the origin, without coincident neighbours.
struct Normalised {
  double size = 0;  // m
  std::vector<Vector3d> points;
};

Normalised Normalise(std::span<const Vector3d> points) {
  Normalised out;
  for (const Vector3d& x : points)
    out.size = std::max(out.size, (x - points[0]).lpNorm<Eigen::Infinity>());
  if (out.size < 1e-100) return out;
  for (const Vector3d& x : points) {
    const Vector3d y = (x - points[0]) / out.size;
    if (out.points.empty() || (y - out.points.back()).norm() > kSame) out.points.push_back(y);
  }
  return out;
}

Matrix3d DefaultRoot(const FitOptions& options) {
  return options.root ? options.root->toRotationMatrix() : FrameAlong(Vector3d::UnitX());
}

Fit Straight(const FitOptions& options, const Vector3d& root, int elements) {
  Fit fit;
  fit.root = {root, Eigen::Quaterniond(DefaultRoot(options))};
  const std::vector<double> fraction = Fractions(elements, options.proportions);
  for (int Q = 0; Q < elements; ++Q) {
    fit.length.push_back(kLeastLength * (fraction[Q + 1] - fraction[Q]));
  }
  fit.theta.assign(elements, Vector3d::Zero());
  fit.largest_distance = fit.rms_distance = kLeastLength;  // The last point's, from the tip.
  return fit;
}

Fit FitElements(const SmoothCurve& curve, const Normalised& polyline, const Vector3d& origin,
                const FitOptions& options, int elements) {
  const std::vector<double> fraction = Fractions(elements, options.proportions);
  std::optional<Matrix3d> root;
  if (options.root) root = options.root->toRotationMatrix();
  Fitter fitter(curve, polyline.points, fraction, root);
  fitter.Run();
  const Fitter::Shape& shape = fitter.shape();
  Fit fit;
  fit.root = {origin, options.root ? *options.root : Eigen::Quaterniond(shape.R).normalized()};
  for (int Q = 0; Q < elements; ++Q) {
    fit.length.push_back(polyline.size * shape.L * (fraction[Q + 1] - fraction[Q]));
  }
  fit.theta = shape.theta;
  fit.largest_distance = polyline.size * fitter.largest_distance();
  fit.rms_distance = polyline.size * fitter.rms_distance();
  fit.smoothed_length = polyline.size * curve.length();
  fit.noise = polyline.size * curve.noise();
  fit.iterations = fitter.iterations();
  return fit;
}

}  // namespace

Fit FitPolyline(std::span<const Vector3d> points, const FitOptions& options) {
  MANE_CHECK(!points.empty());
  MANE_CHECK(1 <= options.fewest && options.fewest <= options.elements);
  const bool bounded = std::isfinite(options.bound);
  MANE_CHECK(options.proportions.empty() ||
             (!bounded && static_cast<int>(options.proportions.size()) == options.elements));
  const Normalised polyline = Normalise(points);
  Fit fit;
  if (polyline.points.size() < 2) {
    fit = Straight(options, points[0], bounded ? options.fewest : options.elements);
  } else {
    const SmoothCurve curve(polyline.points, options.noise / polyline.size);
    const auto with = [&](int elements) {
      Fit result = FitElements(curve, polyline, points[0], options, elements);
      result.bound_met = result.largest_distance <= options.bound;
      return result;
    };
    if (!bounded) {
      fit = with(options.elements);
    } else {
      int tried = options.fewest, missed = tried - 1;
      for (fit = with(tried); !fit.bound_met && tried < options.elements;) {
        missed = tried;
        tried = std::min(2 * tried, options.elements);
        fit = with(tried);
      }
      while (fit.bound_met && tried - missed > 1) {
        const int middle = (missed + tried) / 2;
        Fit fewer = with(middle);
        (fewer.bound_met ? tried : missed) = middle;
        if (fewer.bound_met) fit = std::move(fewer);
      }
    }
  }
  fit.bound_met = fit.largest_distance <= options.bound;
  return fit;
}

}  // namespace mane::rod
