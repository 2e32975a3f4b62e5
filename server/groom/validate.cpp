#include "groom/validate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "groom/range.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr double kSumTolerance = 1e-6;  // Relative, of element lengths.

Result<std::vector<double>> EqualLengths(const std::string& path, const GuideDescription& d) {
  if (d.element_count < 1 || d.element_count > kMaxElementsPerGuide) {
    return OutOfRange(path + "element_count", d.element_count, {1, kMaxElementsPerGuide});
  }
  const Range range{kMinElementLength * d.element_count, kMaxLength, "m"};
  if (!range.Contains(d.length_m)) return OutOfRange(path + "length_m", d.length_m, range);
  return std::vector<double>(d.element_count, d.length_m / d.element_count);
}

Result<std::vector<double>> ElementLengths(const std::string& path, const GuideDescription& d) {
  const std::vector<double>& lengths = d.element_lengths_m;
  if (lengths.empty()) return EqualLengths(path, d);
  const std::string field = path + "element_lengths_m";
  if (lengths.size() > kMaxElementsPerGuide) {
    return InvalidArgument(field, fmt::format("{} holds {} numbers; at most {} are allowed", field,
                                              lengths.size(), kMaxElementsPerGuide));
  }
  if (d.element_count != 0 && d.element_count != lengths.size()) {
    return InvalidArgument(
        path + "element_count",
        fmt::format("{}element_count is {}; it must be 0 or the {} of element_lengths_m", path,
                    d.element_count, lengths.size()));
  }
  const Range element_range{kMinElementLength, kMaxLength, "m"};
  for (size_t i = 0; i < lengths.size(); ++i) {
    if (!element_range.Contains(lengths[i])) {
      return OutOfRange(fmt::format("{}[{}]", field, i), lengths[i], element_range);
    }
  }
  const double sum = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  if (sum > kMaxLength * (1 + kSumTolerance)) {
    return InvalidArgument(
        field, fmt::format("{} sums to {} m; at most {} m is allowed", field, sum, kMaxLength));
  }
  if (d.length_m != 0 && !(std::abs(d.length_m - sum) <= kSumTolerance * sum)) {
    return InvalidArgument(
        path + "length_m",
        fmt::format("{}length_m is {}; it must be 0 or the sum {} m of element_lengths_m to 1e-6",
                    path, d.length_m, sum));
  }
  return lengths;
}

// Writes component `k` of every element's natural curvature.
Result<void> ReadNatural(const std::string& field, const std::vector<double>& values, int k,
                         std::vector<Vector3d>* natural) {
  const size_t N = natural->size();
  if (values.size() > 1 && values.size() != N) {
    return InvalidArgument(field, fmt::format("{} holds {} numbers; it must hold none, one or {}",
                                              field, values.size(), N));
  }
  for (size_t i = 0; i < values.size(); ++i) {
    if (!kCurvatureRange.Contains(values[i])) {
      return OutOfRange(fmt::format("{}[{}]", field, i), values[i], kCurvatureRange);
    }
  }
  if (values.empty()) return {};
  for (size_t i = 0; i < N; ++i) {
    // Adding zero makes -0 a plain zero, so that lists of zeros are one thing.
    (*natural)[i][k] = values[values.size() == 1 ? 0 : i] + 0.0;
  }
  return {};
}

// The shortest list that says component `k`: none for zeros, one number, or all.
std::vector<double> DescribeNatural(const std::vector<Vector3d>& natural, int k) {
  const double first = natural[0][k];
  const bool same = std::ranges::all_of(natural, [&](const Vector3d& n) { return n[k] == first; });
  if (same && first == 0) return {};
  if (same) return {first};
  std::vector<double> values(natural.size());
  std::ranges::transform(natural, values.begin(), [k](const Vector3d& n) { return n[k]; });
  return values;
}

}  // namespace

Result<void> ValidateProperties(const std::string& path, const GuideDescription& d) {
  const struct {
    const char* name;
    double value;
    Range range;
  } fields[] = {
      {"radius_1_m", d.radius_1_m, {1e-6, 1e-2, "m"}},
      {"radius_2_m", d.radius_2_m, {1e-6, 1e-2, "m"}},
      {"young_modulus_pa", d.young_modulus_pa, kYoungModulusRange},
      {"poisson_ratio", d.poisson_ratio, {-1, 0.5, "", true}},
      {"density_kg_m3", d.density_kg_m3, {1, 1e5, "kg/m^3"}},
      {"internal_friction", d.internal_friction, {0, 1, "kg m^3/s"}},
      {"air_drag", d.air_drag, {0, 10, "kg/(m s)"}},
  };
  for (const auto& field : fields) {
    if (!field.range.Contains(field.value)) {
      return OutOfRange(path + field.name, field.value, field.range);
    }
  }
  return {};
}

Result<Guide> MakeGuide(const GuideDescription& d, int index) {
  const std::string path = fmt::format("guides[{}].", index);
  Guide guide;
  guide.root.p = d.root_position;
  if (auto root = CheckVector(path + "root_position", d.root_position, kCoordinateRange); !root) {
    return root.error();
  }
  auto q = UnitQuaternion(path + "root_frame", d.root_frame);
  if (!q) return q.error();
  guide.root.q = *q;

  auto lengths = ElementLengths(path, d);
  if (!lengths) return lengths.error();
  if (auto scalars = ValidateProperties(path, d); !scalars) return scalars.error();

  rod::Strand& strand = guide.strand;
  strand.length = *std::move(lengths);
  strand.natural.assign(strand.length.size(), Vector3d::Zero());
  const struct {
    const char* name;
    const std::vector<double>& values;
  } naturals[] = {{"natural_twist", d.natural_twist},
                  {"natural_curvature_1", d.natural_curvature_1},
                  {"natural_curvature_2", d.natural_curvature_2}};
  for (int k = 0; k < 3; ++k) {
    auto read = ReadNatural(path + naturals[k].name, naturals[k].values, k, &strand.natural);
    if (!read) return read.error();
  }

  guide.section = {d.radius_1_m, d.radius_2_m};
  guide.material = {d.young_modulus_pa, d.poisson_ratio, d.density_kg_m3};
  strand.stiffness = rod::Stiffness(guide.section, guide.material);
  strand.linear_density = rod::LinearDensity(guide.section, guide.material);
  strand.internal_friction = d.internal_friction;
  strand.air_drag = d.air_drag;
  if (!kWispRadiusRange.Contains(d.wisp_radius_m)) {
    return OutOfRange(path + "wisp_radius_m", d.wisp_radius_m, kWispRadiusRange);
  }
  guide.wisp_radius = d.wisp_radius_m;
  if (auto ok = CheckModel(path + "model", d.model); !ok) return ok.error();
  if (d.model == StrandModel::kWound) {
    if (auto wound = MakeWound(index, &guide); !wound) return wound.error();
  }
  return guide;
}

Result<void> CheckModel(const std::string& field, StrandModel model) {
  if (model == StrandModel::kSuperHelix || model == StrandModel::kWound) return {};
  return InvalidArgument(field, fmt::format("{} is {}; it must be SUPER_HELIX (1) or WOUND (2)",
                                            field, static_cast<int>(model) + 1));
}

Result<void> MakeWound(int index, Guide* guide) {
  if (!rod::IsWound(guide->strand)) {
    const std::string field = fmt::format("guides[{}].model", index);
    return InvalidArgument(
        field,
        fmt::format("{} is WOUND, but the natural shape, of {:.3g} turns in {} elements, is no "
                    "coil for that: it must turn 5 times or more, more than half a turn an "
                    "element and 0.2 in each, and its axis by at most 0.5 rad from one to the "
                    "next; use fewer elements, more even curvatures, or SUPER_HELIX",
                    field, rod::NaturalTurns(guide->strand), guide->strand.elements()));
  }
  guide->wound = rod::MakeWound(guide->strand);
  return {};
}

GuideDescription Describe(const Guide& guide) {
  const rod::Strand& strand = guide.strand;
  GuideDescription d;
  d.root_position = guide.root.p;
  d.root_frame = guide.root.q;
  d.element_count = static_cast<uint32_t>(strand.elements());
  // One length says it where dividing it gives the elements' lengths again; else they are listed.
  const double first = strand.length[0];
  d.length_m = first * strand.elements();
  const bool equal = std::ranges::all_of(strand.length, [&](double l) { return l == first; });
  if (!equal || d.length_m / d.element_count != first || d.length_m > kMaxLength ||
      d.length_m < kMinElementLength * strand.elements()) {
    d.element_lengths_m = strand.length;
    d.length_m = std::min(strand.TotalLength(), kMaxLength);
  }
  d.radius_1_m = guide.section.radius_1;
  d.radius_2_m = guide.section.radius_2;
  d.young_modulus_pa = guide.material.young_modulus;
  d.poisson_ratio = guide.material.poisson_ratio;
  d.density_kg_m3 = guide.material.density;
  d.internal_friction = strand.internal_friction;
  d.air_drag = strand.air_drag;
  d.natural_twist = DescribeNatural(strand.natural, 0);
  d.natural_curvature_1 = DescribeNatural(strand.natural, 1);
  d.natural_curvature_2 = DescribeNatural(strand.natural, 2);
  if (guide.wound) d.model = StrandModel::kWound;
  d.wisp_radius_m = guide.wisp_radius;
  return d;
}

}  // namespace mane::groom
