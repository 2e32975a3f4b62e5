#include "groom/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "groom/describe.h"
#include "groom/presets.h"
#include "groom/range.h"
#include "groom/resolution.h"
#include "groom/validate.h"
#include "rod/chain.h"
#include "rod/fit.h"
#include "rod/inverse_statics.h"
#include "rod/scheme.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

const Vector3d kGravity(0, -9.81, 0);
// Of the length: what settles within it is not called sagging.
constexpr double kSettled = 1e-4;
constexpr double kLengthTolerance = 1e-6;  // Relative: points are float32.

void Apply(const HairProperties& properties, GuideDescription* d) {
  const auto apply = [](const std::optional<double>& given, double* value) {
    if (given) *value = *given;
  };
  apply(properties.radius_1_m, &d->radius_1_m);
  apply(properties.radius_2_m, &d->radius_2_m);
  apply(properties.young_modulus_pa, &d->young_modulus_pa);
  apply(properties.poisson_ratio, &d->poisson_ratio);
  apply(properties.density_kg_m3, &d->density_kg_m3);
  apply(properties.internal_friction, &d->internal_friction);
  apply(properties.air_drag, &d->air_drag);
}

// Section, material and damping of strands that name none of their own.
GuideDescription CommonProperties(const ImportOptions& options) {
  GuideDescription d;
  SetProperties(PresetOf(options.hair_type), &d);
  Apply(options.properties, &d);
  return d;
}

double Length(std::span<const Vector3d> points) {
  double length = 0;
  for (size_t i = 1; i < points.size(); ++i) length += (points[i] - points[i - 1]).norm();
  return length;
}

std::vector<Vector3d> Points(const ImportedStrand& strand) {
  std::vector<Vector3d> points;
  points.reserve(strand.points.size());
  for (const Eigen::Vector3f& point : strand.points) points.emplace_back(point.cast<double>());
  return points;
}

Result<void> ValidatePoints(std::span<const Vector3d> points, const std::string& field,
                            uint32_t elements) {
  if (points.size() < 2 || points.size() > kMaxPointsPerStrand) {
    return InvalidArgument(field, fmt::format("{} holds {} points; a strand needs 2 to {}", field,
                                              points.size(), kMaxPointsPerStrand));
  }
  for (size_t i = 0; i < points.size(); ++i) {
    const std::string path = fmt::format("{}[{}]", field, i);
    if (auto ok = CheckVector(path, points[i], kCoordinateRange); !ok) return ok;
  }
  const double length = Length(points);
  const double least = kMinElementLength * elements;
  if (length >= least * (1 - kLengthTolerance) && length <= kMaxLength * (1 + kLengthTolerance)) {
    return {};
  }
  return InvalidArgument(
      field, fmt::format("{} is a polyline of {:.6g} m; it must be between {:.6g} m, {:g} m an "
                         "element, and {:g} m long",
                         field, length, least, kMinElementLength, kMaxLength));
}

double LengthOf(const rod::Fit& fit) {
  return std::accumulate(fit.length.begin(), fit.length.end(), 0.0);
}

rod::Fit FitStrand(const ImportedStrand& strand, const ImportOptions& options) {
  const std::vector<Vector3d> points = Points(strand);
  rod::FitOptions fit_options;
  fit_options.elements = static_cast<int>(options.element_count);
  if (strand.root_frame) fit_options.root = strand.root_frame->normalized();
  fit_options.noise = options.noise_m.value_or(-1);
  if (options.error_bound_m > 0) {
    fit_options.bound = options.error_bound_m;
    // The count of straight hair is what motion needs, however few elements would fit.
    fit_options.fewest = std::min(
        ElementCountFor(HairType::kAsianSmooth, Length(points), kDefaultErrorTarget, false),
        fit_options.elements);
  }
  rod::Fit fit = rod::FitPolyline(points, fit_options);
  // A fit may be a few percent shorter or longer than the polyline.
  const double shrink = std::min(1.0, kMaxLength / LengthOf(fit));
  for (double& length : fit.length) length = std::max(length * shrink, kMinElementLength);
  return fit;
}

bool IsNatural(const Vector3d& curvatures) {
  return std::ranges::all_of(curvatures, [](double k) { return kCurvatureRange.Contains(k); });
}

// Makes the shape the natural one, as far as a guide may have it, and lets it settle from there.
std::vector<Vector3d> Sag(const rod::Fit& fit, rod::Strand* strand, StrandOutcome* outcome) {
  for (size_t Q = 0; Q < fit.theta.size(); ++Q) {
    strand->natural[Q] =
        (fit.theta[Q] / fit.length[Q]).cwiseMax(kCurvatureRange.low).cwiseMin(kCurvatureRange.high);
  }
  std::vector<Vector3d> rest = fit.theta;
  (void)rod::SolveRestShape(*strand, fit.root, kGravity, rest);
  const auto wanted = rod::ElementFrames(*strand, fit.root, fit.theta);
  const auto reached = rod::ElementFrames(*strand, fit.root, rest);
  double largest = 0;
  for (size_t Q = 0; Q < wanted.size(); ++Q) {
    largest = std::max(largest, (reached[Q].r - wanted[Q].r).norm());
  }
  outcome->tip_deviation = static_cast<float>((reached.back().r - wanted.back().r).norm());
  outcome->largest_deviation = static_cast<float>(largest);
  outcome->held = largest <= kSettled * LengthOf(fit);
  return rest;
}

// Makes the shape an equilibrium. Returns it, or where the strand goes instead. Where that takes
// natural curvatures that no guide may have, the strand sags with the stiffness that it has.
std::vector<Vector3d> Hold(const rod::Fit& fit, const ImportOptions& options, double young_modulus,
                           rod::Strand* strand, double* stiffness_factor, StrandOutcome* outcome) {
  rod::HoldOptions hold;
  hold.max_stiffness_factor =
      std::clamp(kYoungModulusRange.high / young_modulus, 1.0, options.max_stiffness_factor);
  hold.margin = options.stability_margin;
  hold.longest_step = rod::kLongestStep;
  const Vector3d nominal = strand->stiffness;
  std::vector<Vector3d> rest(fit.theta.size());
  const rod::HoldReport report = rod::HoldShape(*strand, fit.root, kGravity, fit.theta, hold, rest);
  outcome->needed_stiffness_factor = static_cast<float>(report.needed_factor);
  if (!std::ranges::all_of(strand->natural, IsNatural)) {
    strand->stiffness = nominal;
    rest = Sag(fit, strand, outcome);
    outcome->held = false;
    return rest;
  }
  *stiffness_factor = report.stiffness_factor;
  outcome->held = report.held;
  outcome->stiffness_factor = static_cast<float>(report.stiffness_factor);
  outcome->tip_deviation = static_cast<float>(report.tip_deviation);
  outcome->largest_deviation = static_cast<float>(report.largest_deviation);
  return report.held ? fit.theta : rest;
}

// What no search could settle stays as it is, and is reported to be anywhere.
void TakeFinite(const rod::Fit& fit, std::vector<Vector3d>* rest, StrandOutcome* outcome) {
  const bool finite =
      std::ranges::all_of(*rest, [](const Vector3d& theta) { return theta.allFinite(); });
  if (finite && std::isfinite(outcome->largest_deviation)) return;
  *rest = fit.theta;
  outcome->held = false;
  outcome->tip_deviation = outcome->largest_deviation = static_cast<float>(LengthOf(fit));
}

struct ImportedGuide {
  Guide guide;
  std::vector<Vector3d> rest;
  StrandOutcome outcome;
};

Result<ImportedGuide> ImportStrand(const ImportedStrand& strand, const ImportOptions& options,
                                   int index) {
  const rod::Fit fit = FitStrand(strand, options);
  ImportedGuide out;
  out.outcome.point_count = static_cast<uint32_t>(strand.points.size());
  out.outcome.element_count = static_cast<uint32_t>(fit.length.size());
  out.outcome.largest_fit_distance = static_cast<float>(fit.largest_distance);
  out.outcome.rms_fit_distance = static_cast<float>(fit.rms_distance);
  out.outcome.bound_met = options.error_bound_m == 0 || fit.bound_met;

  GuideDescription d = CommonProperties(options);
  Apply(strand.properties, &d);
  d.root_position = fit.root.p;
  d.root_frame = fit.root.q;
  d.element_lengths_m = fit.length;
  d.wisp_radius_m = options.wisp_radius_m;
  auto weightless = MakeGuide(d, index);
  if (!weightless) return weightless.error();
  rod::Strand& rod = weightless->strand;
  double stiffness_factor = 1;
  out.rest = options.hold
                 ? Hold(fit, options, d.young_modulus_pa, &rod, &stiffness_factor, &out.outcome)
                 : Sag(fit, &rod, &out.outcome);
  TakeFinite(fit, &out.rest, &out.outcome);
  d.young_modulus_pa = std::min(d.young_modulus_pa * stiffness_factor, kYoungModulusRange.high);
  SetNatural(rod.natural, &d);
  auto guide = MakeGuide(d, index);
  if (!guide) return guide.error();
  out.guide = *std::move(guide);
  return out;
}

}  // namespace

Result<void> ValidateImportOptions(const ImportOptions& options) {
  const std::string path = "header.import_options.";
  if (options.hair_type == HairType::kCustom) {
    return InvalidArgument(path + "hair_type", path + "hair_type is unset; it must be a preset");
  }
  const struct {
    const char* name;
    double value;
    Range range;
  } fields[] = {
      {"element_count", double(options.element_count), {1, kMaxElementsPerStrand}},
      {"error_bound_m", options.error_bound_m, {0, 1, "m"}},
      {"noise_m", options.noise_m.value_or(0), {0, 0.1, "m"}},
      {"max_stiffness_factor", options.max_stiffness_factor, {1, 1000}},
      {"stability_margin", options.stability_margin, {0, 0.9}},
      {"wisp_radius_m", options.wisp_radius_m, kWispRadiusRange},
  };
  for (const auto& field : fields) {
    if (!field.range.Contains(field.value)) {
      return OutOfRange(path + field.name, field.value, field.range);
    }
  }
  return ValidateProperties(path + "properties.", CommonProperties(options));
}

Result<void> ValidateStrand(const ImportedStrand& strand, const ImportOptions& options, int index) {
  const std::string path = fmt::format("strands[{}].", index);
  if (auto ok = ValidatePoints(Points(strand), path + "points", options.element_count); !ok) {
    return ok;
  }
  if (strand.root_frame) {
    if (auto q = UnitQuaternion(path + "root_frame", *strand.root_frame); !q) return q.error();
  }
  GuideDescription d = CommonProperties(options);
  Apply(strand.properties, &d);
  return ValidateProperties(path + "properties.", d);
}

double ImportCost(size_t points, const ImportOptions& options) {
  constexpr double kPerPoint = 1e-3, kPerCubedElement = 1e-6;  // s
  constexpr double kPerHeldElement = 2e-3;                     // s
  constexpr double kSearch = 4;  // Fits that a search for a bound tries.
  const double N = options.element_count;
  const double fit = kPerPoint * static_cast<double>(points) + kPerCubedElement * N * N * N;
  const double hold = options.hold ? kPerHeldElement * N : 0;
  return (options.error_bound_m > 0 ? kSearch * fit : fit) + hold;
}

Result<Import> ImportStrands(std::span<const ImportedStrand> strands, const ImportOptions& options,
                             exec::WorkerPool& pool, const base::Cancelled& cancelled) {
  const int n = static_cast<int>(strands.size());
  std::vector<std::optional<Result<ImportedGuide>>> imported(n);
  // After a failure only strands before it go on, so that always the first one is named.
  std::atomic<int> first_failed = n;
  pool.ParallelFor(n, 1, [&](int i, int) {
    if (base::IsCancelled(cancelled) || i > first_failed) return;
    imported[i] = ImportStrand(strands[i], options, i);
    if (imported[i]->has_value()) return;
    for (int first = first_failed; i < first && !first_failed.compare_exchange_weak(first, i);) {
    }
  });
  if (base::IsCancelled(cancelled))
    return Error{ErrorCode::kCancelled, "the import was cancelled", ""};
  if (const int i = first_failed; i < n) {
    const Error& error = imported[i]->error();
    return Error{error.code,
                 fmt::format("strands[{}], fitted, is no valid guide: {}", i, error.message),
                 fmt::format("strands[{}]", i)};
  }
  Import import;
  for (auto& result : imported) {
    ImportedGuide& one = **result;
    import.guides.push_back(std::move(one.guide));
    for (const Vector3d& theta : one.rest)
      import.rest.insert(import.rest.end(), theta.begin(), theta.end());
    import.outcomes.push_back(one.outcome);
  }
  return import;
}

}  // namespace mane::groom
