#include "rpc/convert_style_values.h"

#include <algorithm>
#include <memory>
#include <span>

#include "rpc/convert_values.h"
#include "rpc/limits.h"
#include "styling/png_image.h"
#include "styling/synthesis.h"

namespace mane::rpc {
namespace {

constexpr int kMaxStops = 1000;
constexpr int kMaxHalfSpaces = 16;
constexpr int kMaxWispNumbers = 20'000;
constexpr int kMaxDensities = 1000;
constexpr size_t kMaxPrototypePoints = 4096;

Result<styling::Stop> ToStop(const v1::Stop& message, const std::string& /*field*/) {
  return styling::Stop{message.at(), message.value()};
}

}  // namespace

Result<std::shared_ptr<const styling::MapImage>> ImageReader::Read(const std::string& png,
                                                                   const std::string& field) {
  if (png.empty()) return std::shared_ptr<const styling::MapImage>();
  const auto found = read_.find(png);
  if (found != read_.end()) return found->second;
  const auto bytes = std::as_bytes(std::span(png));
  pixels_ += styling::PixelsOf(bytes);
  if (pixels_ > kMaxPixels) {
    return Error{ErrorCode::kResourceExhausted,
                 fmt::format("the images up to {} have {} pixels together; at most {} are allowed: "
                             "use smaller images",
                             field, pixels_, kMaxPixels),
                 field};
  }
  auto image = styling::DecodePng(bytes, field);
  if (!image) return image.error();
  const auto shared = std::make_shared<const styling::MapImage>(*std::move(image));
  read_.emplace(png, shared);
  return std::shared_ptr<const styling::MapImage>(shared);
}

Result<void> CheckCount(const std::string& field, long count, long most) {
  if (count <= most) return {};
  return InvalidArgument(
      field, fmt::format("{} has {} entries; at most {} are allowed", field, count, most));
}

Result<styling::ScalpMap> ToMap(const v1::ScalpMap& message, double unset, const std::string& field,
                                ImageReader* images) {
  styling::ScalpMap map;
  map.value = message.has_value() ? message.value() : unset;
  auto by_polar = ToList(message.by_polar(), field + ".by_polar", kMaxStops, ToStop);
  if (!by_polar) return by_polar.error();
  map.by_polar = *std::move(by_polar);
  auto by_azimuth = ToList(message.by_azimuth(), field + ".by_azimuth", kMaxStops, ToStop);
  if (!by_azimuth) return by_azimuth.error();
  map.by_azimuth = *std::move(by_azimuth);
  auto image = images->Read(message.png(), field + ".png");
  if (!image) return image.error();
  map.image = *std::move(image);
  return map;
}

Result<styling::Region::HalfSpace> ToHalfSpace(const v1::ScalpRegion::HalfSpace& message,
                                               const std::string& /*field*/) {
  return styling::Region::HalfSpace{ToVector(message.normal()), message.offset_m()};
}

Result<styling::Region> ToRegion(const v1::ScalpRegion& message, const std::string& field,
                                 ImageReader* images) {
  styling::Region region;
  if (message.has_polar()) region.polar = {message.polar().low(), message.polar().high()};
  if (message.has_azimuth()) region.azimuth = {message.azimuth().low(), message.azimuth().high()};
  auto half_spaces =
      ToList(message.half_spaces(), field + ".half_spaces", kMaxHalfSpaces, ToHalfSpace);
  if (!half_spaces) return half_spaces.error();
  region.half_spaces = *std::move(half_spaces);
  auto mask = images->Read(message.mask_png(), field + ".mask_png");
  if (!mask) return mask.error();
  region.mask = *std::move(mask);
  if (const auto ok = CheckCount(field + ".wisps", message.wisps_size(), kMaxWispNumbers); !ok) {
    return ok.error();
  }
  region.wisps.assign(message.wisps().begin(), message.wisps().end());
  return region;
}

Result<styling::Distribution> ToDistribution(const v1::Distribution& message,
                                             const styling::Distribution& unset,
                                             const std::string& field) {
  using Form = styling::Distribution::Form;
  switch (message.form_case()) {
    case v1::Distribution::kConstant:
      return styling::Distribution{Form::kConstant, message.constant().value(), 0, 0, 0, {}};
    case v1::Distribution::kUniform:
      return styling::Distribution{Form::kUniform,           0, 0, message.uniform().low(),
                                   message.uniform().high(), {}};
    case v1::Distribution::kNormal:
      return styling::Distribution{
          Form::kNormal,          message.normal().mean(), message.normal().deviation(),
          message.normal().low(), message.normal().high(), {}};
    case v1::Distribution::kSampled: {
      const auto& sampled = message.sampled();
      const auto ok =
          CheckCount(field + ".sampled.densities", sampled.densities_size(), kMaxDensities);
      if (!ok) return ok.error();
      return styling::Distribution{Form::kSampled,
                                   0,
                                   0,
                                   sampled.low(),
                                   sampled.high(),
                                   {sampled.densities().begin(), sampled.densities().end()}};
    }
    case v1::Distribution::FORM_NOT_SET:
      break;
  }
  return unset;
}

Result<styling::Synthesis> ToSynthesis(const v1::Synthesis& message, const std::string& field) {
  styling::Synthesis synthesis;
  const v1::Prototype& prototype = message.prototype();
  const std::string path = field + ".prototype";
  if (!v1::StrandKind_IsValid(prototype.kind())) {
    return InvalidArgument(path + ".kind",
                           fmt::format("{}.kind is {}; it must be one of StrandKind", path,
                                       static_cast<int>(prototype.kind())));
  }
  if (prototype.kind() != v1::STRAND_KIND_UNSPECIFIED) {
    synthesis.prototype.kind = static_cast<styling::StrandKind>(prototype.kind() - 1);
  }
  synthesis.prototype.amplitude_m = prototype.amplitude_m();
  synthesis.prototype.period_m = prototype.period_m();
  std::vector<Eigen::Vector3f> points;
  if (const auto ok = AppendBytes(prototype.points(), path + ".points", &points); !ok) {
    return ok.error();
  }
  const auto ok = CheckCount(path + ".points", std::ssize(points), kMaxPrototypePoints);
  if (!ok) return ok.error();
  for (const Eigen::Vector3f& p : points) synthesis.prototype.points.emplace_back(p.cast<double>());
  if (const auto fits = CheckRange(field + ".window", message.window(), 0, styling::kMostWindow);
      !fits) {
    return fits.error();
  }
  synthesis.window = static_cast<int>(message.window());
  synthesis.temperature = message.temperature();
  return synthesis;
}

}  // namespace mane::rpc
