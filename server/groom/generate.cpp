#include "groom/generate.h"

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "groom/describe.h"
#include "groom/presets.h"
#include "groom/range.h"
#include "groom/resolution.h"
#include "groom/sampler.h"
#include "groom/validate.h"
#include "math/random.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// A smooth random function on [0, 1] of mean 0 and variance 1 (see CurlVariation).
class SmoothNoise {
 public:
  explicit SmoothNoise(math::RandomStream& random) {
    for (Wave& wave : waves_) wave = {random.Uniform(0, 2), random.Uniform()};
  }
  [[nodiscard]] double At(double u) const {
    double sum = 0;
    for (const Wave& wave : waves_) sum += std::cos(2 * pi * (wave.frequency * u + wave.phase));
    return std::sqrt(2.0 / 3) * sum;
  }

 private:
  struct Wave {
    double frequency;  // Periods along the strand.
    double phase;      // Periods.
  };
  std::array<Wave, 3> waves_;
};

Result<void> Validate(const Scalp& scalp, const Generation& generation, const Limits& limits) {
  const std::string path = "header.generate";
  if (std::holds_alternative<std::monostate>(scalp)) {
    return InvalidArgument(path, path + " needs a scalp: send header.ellipsoid or scalp_mesh");
  }
  if (generation.hair_type == HairType::kCustom) {
    return InvalidArgument(path + ".hair_type", path + ".hair_type is unset; it must be a preset");
  }
  if (generation.guide_count > static_cast<uint32_t>(limits.max_guides)) {
    return TooMany(path + ".guide_count", "guides", generation.guide_count, limits.max_guides);
  }
  const struct {
    const char* name;
    double value;
    Range range;
  } fields[] = {
      {".guide_count", double(generation.guide_count), {1, double(limits.max_guides)}},
      {".length_m", generation.length_m, {0, kMaxLength, "m", true}},
      {".element_count", double(generation.element_count), {0, kMaxElementsPerGuide}},
      {".error_target", generation.error_target.value_or(kDefaultErrorTarget), {1e-3, 0.2}},
      {".curl_variation", generation.curl_variation, {0, 1}},
      {".root_droop", generation.root_droop, {0, 1}},
      {".wisp_radius_m", generation.wisp_radius_m, kWispRadiusRange},
  };
  for (const auto& field : fields) {
    if (!field.range.Contains(field.value)) {
      return OutOfRange(path + field.name, field.value, field.range);
    }
  }
  if (generation.error_target && generation.element_count != 0) {
    return InvalidArgument(
        path + ".error_target",
        fmt::format("{0}.error_target is {1} beside {0}.element_count {2}; give one of them", path,
                    *generation.error_target, generation.element_count));
  }
  if (generation.model) {
    const std::string model = path + ".model";
    if (auto ok = CheckModel(model, *generation.model); !ok) return ok;
    if (*generation.model == StrandModel::kWound &&
        NaturalCurvature(PresetOf(generation.hair_type)).isZero()) {
      return InvalidArgument(model, model + " is WOUND, but this hair type is straight");
    }
  }
  return ValidateScalp(scalp, limits);
}

// What all guides of `generation` share.
GuideDescription CommonDescription(const Preset& preset, std::vector<double> lengths) {
  GuideDescription d;
  d.element_lengths_m = std::move(lengths);
  SetProperties(preset, &d);
  return d;
}

// Whether a strand is a coil that moves rightly, and comes to rest, as a wound one.
bool MayBeWound(const rod::Strand& strand) {
  return rod::IsWound(strand) && rod::CoilWeight(strand) <= rod::kMostCoilWeight;
}

// Whether the guides are to be wound strands: as asked for, or where the hair of even curl would
// be, unless plain ones come nearer to the error target.
bool MostlyWound(const Generation& generation) {
  if (generation.model) return *generation.model == StrandModel::kWound;
  const double target = generation.error_target.value_or(kDefaultErrorTarget);
  const HairType type = generation.hair_type;
  if (generation.element_count != 0) {
    const int N = static_cast<int>(generation.element_count);
    return MayBeWound(PresetStrand(type, generation.length_m, N));
  }
  if (target < kWoundError && IsResolved(type, generation.length_m)) return false;
  const int N = ElementCountFor(type, generation.length_m, target, true);
  return MayBeWound(PresetStrand(type, generation.length_m, N));
}

}  // namespace

Result<std::vector<Guide>> Generate(const Scalp& scalp, const Generation& generation,
                                    const Limits& limits) {
  if (auto valid = Validate(scalp, generation, limits); !valid) return valid.error();
  const int n = static_cast<int>(generation.guide_count);
  const bool wound = MostlyWound(generation);
  const int N = generation.element_count != 0
                    ? static_cast<int>(generation.element_count)
                    : ElementCountFor(generation.hair_type, generation.length_m,
                                      generation.error_target.value_or(kDefaultErrorTarget), wound);
  if (const long elements = long{n} * N; elements > limits.max_elements) {
    return TooMany("header.generate.guide_count", "elements", elements, limits.max_elements);
  }
  const std::vector<double> lengths =
      rod::GradedLengths(GradingOf(generation.hair_type, generation.length_m, wound), N);
  const double shortest = *std::ranges::min_element(lengths) / generation.length_m;
  if (const Range range{kMinElementLength / shortest, kMaxLength, "m"};
      !range.Contains(generation.length_m)) {
    return OutOfRange("header.generate.length_m", generation.length_m, range);
  }

  const Preset preset = PresetOf(generation.hair_type);
  const Vector3d mean = NaturalCurvature(preset);
  const std::vector<ScalpPoint> roots = SampleScalp(scalp, n, generation.seed);
  GuideDescription d = CommonDescription(preset, lengths);
  d.wisp_radius_m = generation.wisp_radius_m;
  std::vector<Guide> guides;
  guides.reserve(n);
  for (int i = 0; i < n; ++i) {
    math::RandomStream random(generation.seed, static_cast<uint64_t>(i));
    d.root_position = roots[i].position;
    d.root_frame = RootFrame(roots[i].normal, generation.root_droop, random.Uniform(0, 2 * pi));
    SetNatural(CurlVariation(mean, generation.curl_variation, lengths, random), &d);
    auto guide = MakeGuide(d, i);
    if (!guide) return guide.error();
    // One whose curl varies too much for that, or that is too heavy, stays plain.
    if (wound && MayBeWound(guide->strand)) {
      if (auto made = MakeWound(i, &*guide); !made) return made.error();
    }
    guides.push_back(*std::move(guide));
  }
  return guides;
}

Eigen::Quaterniond RootFrame(const Vector3d& normal, double droop, double phase) {
  // The downward direction along the surface, of length sin(angle from the vertical).
  const Vector3d down = -Vector3d::UnitY() + normal.y() * normal;
  const double slope = down.norm();
  const double lean = droop * pi / 2 * slope;
  const double along = slope > 1e-9 ? std::sin(lean) / slope : droop * pi / 2;
  const Vector3d n0 = (std::cos(lean) * normal + along * down).normalized();
  const Eigen::Quaterniond leave = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), n0);
  return (leave * Eigen::AngleAxisd(phase, Vector3d::UnitX())).normalized();
}

std::vector<Vector3d> CurlVariation(const Vector3d& mean, double relative,
                                    std::span<const double> lengths, math::RandomStream& random) {
  const std::array<SmoothNoise, 3> noise{SmoothNoise(random), SmoothNoise(random),
                                         SmoothNoise(random)};
  const Vector3d scale = relative * Vector3d(mean[0], mean[1], mean[1]);
  const double L = std::accumulate(lengths.begin(), lengths.end(), 0.0);
  std::vector<Vector3d> natural(lengths.size(), mean);
  double left = 0;
  for (size_t Q = 0; Q < lengths.size(); ++Q) {
    const double middle = (left + 0.5 * lengths[Q]) / L;
    for (int k = 0; k < 3; ++k) natural[Q][k] += scale[k] * noise[k].At(middle);
    left += lengths[Q];
  }
  return natural;
}

}  // namespace mane::groom
