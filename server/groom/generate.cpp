#include "groom/generate.h"

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "groom/describe.h"
#include "groom/presets.h"
#include "groom/range.h"
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
      {".curl_variation", generation.curl_variation, {0, 1}},
      {".root_droop", generation.root_droop, {0, 1}},
  };
  for (const auto& field : fields) {
    if (!field.range.Contains(field.value)) {
      return OutOfRange(path + field.name, field.value, field.range);
    }
  }
  return ValidateScalp(scalp, limits);
}

// What all guides of `generation` share.
GuideDescription CommonDescription(const Preset& preset, const Generation& generation, int N) {
  GuideDescription d;
  d.length_m = generation.length_m;
  d.element_count = static_cast<uint32_t>(N);
  SetProperties(preset, &d);
  return d;
}

}  // namespace

Result<std::vector<Guide>> Generate(const Scalp& scalp, const Generation& generation,
                                    const Limits& limits) {
  if (auto valid = Validate(scalp, generation, limits); !valid) return valid.error();
  const int n = static_cast<int>(generation.guide_count);
  const int N = generation.element_count != 0
                    ? static_cast<int>(generation.element_count)
                    : DefaultElementCount(generation.hair_type, generation.length_m);
  if (const long elements = long{n} * N; elements > limits.max_elements) {
    return TooMany("header.generate.guide_count", "elements", elements, limits.max_elements);
  }
  if (const Range range{kMinElementLength * N, kMaxLength, "m"};
      !range.Contains(generation.length_m)) {
    return OutOfRange("header.generate.length_m", generation.length_m, range);
  }

  const Preset preset = PresetOf(generation.hair_type);
  const Vector3d mean = NaturalCurvature(preset);
  const std::vector<ScalpPoint> roots = SampleScalp(scalp, n, generation.seed);
  GuideDescription d = CommonDescription(preset, generation, N);
  std::vector<Guide> guides;
  guides.reserve(n);
  for (int i = 0; i < n; ++i) {
    math::RandomStream random(generation.seed, static_cast<uint64_t>(i));
    d.root_position = roots[i].position;
    d.root_frame = RootFrame(roots[i].normal, generation.root_droop, random.Uniform(0, 2 * pi));
    SetNatural(CurlVariation(mean, generation.curl_variation, N, random), &d);
    auto guide = MakeGuide(d, i);
    if (!guide) return guide.error();
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

std::vector<Vector3d> CurlVariation(const Vector3d& mean, double relative, int N,
                                    math::RandomStream& random) {
  const std::array<SmoothNoise, 3> noise{SmoothNoise(random), SmoothNoise(random),
                                         SmoothNoise(random)};
  const Vector3d scale = relative * Vector3d(mean[0], mean[1], mean[1]);
  std::vector<Vector3d> natural(N, mean);
  for (int Q = 0; Q < N; ++Q) {
    for (int k = 0; k < 3; ++k) natural[Q][k] += scale[k] * noise[k].At((Q + 0.5) / N);
  }
  return natural;
}

}  // namespace mane::groom
