#include "beam/pores.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "math/random.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr int kSteps = 1024;  // Of an integral over a region.
constexpr double kGolden = std::numbers::phi - 1;

// From the beginning of a region, through the nape where need be.
double AzimuthAt(const PoreRegion& region, double beyond) {
  const double azimuth = region.from_azimuth + beyond;
  return azimuth > pi ? azimuth - 2 * pi : azimuth;
}

// Of a function over [0, 1] up to equal steps, by midpoints.
template <typename F>
std::vector<double> Integral(const F& f) {
  std::vector<double> sum(1, 0);
  for (int i = 0; i < kSteps; ++i) sum.emplace_back(sum.back() + f((i + 0.5) / kSteps) / kSteps);
  return sum;
}

double ValueAt(const std::vector<double>& integral, double share) {
  const int step = std::min(static_cast<int>(share * kSteps), kSteps - 1);
  return std::lerp(integral[step], integral[step + 1], share * kSteps - step);
}

// Where in [0, 1] an integral, which grows, has a value.
double Inverse(const std::vector<double>& integral, double value) {
  const auto found = std::ranges::upper_bound(integral, value) - integral.begin();
  const auto step = std::clamp<std::ptrdiff_t>(found - 1, 0, kSteps - 1);
  const double part = (value - integral[step]) / (integral[step + 1] - integral[step]);
  return std::clamp((static_cast<double>(step) + part) / kSteps, 0.0, 1.0);
}

}  // namespace

double AzimuthsOf(const PoreRegion& region) {
  const double width = region.to_azimuth - region.from_azimuth;
  return region.from_azimuth > region.to_azimuth ? width + 2 * pi : width;
}

bool Contains(const PoreRegion& region, const Polar& pore) {
  if (pore.zenith < region.least_zenith || pore.zenith > region.greatest_zenith) return false;
  const bool after = pore.azimuth >= region.from_azimuth,
             before = pore.azimuth <= region.to_azimuth;
  return region.from_azimuth > region.to_azimuth ? after || before : after && before;
}

uint64_t StreamOf(int part, int hair, Purpose purpose) {
  return (uint64_t{2} * part + static_cast<uint64_t>(purpose)) << 32 | static_cast<uint64_t>(hair);
}

Pores::Pores(const Hull& hull, const Part& part, uint64_t seed, int index)
    : hull_(hull), part_(part), seed_(seed), index_(index), azimuths_(AzimuthsOf(part.pores)) {
  if (part_.spread == Part::Spread::kUniform && !part_.tied_at) LayRows();
}

Pore Pores::At(int hair) const {
  if (part_.tied_at) return Tied(hair);
  const Polar polar = part_.spread == Part::Spread::kRandom ? Random(hair) : Even(hair);
  const Vector3d root = hull_.Point(polar.zenith, polar.azimuth);
  return {root, hull_.Gradient(root).normalized(), polar};
}

// On a disc: drawn evenly, or as the seeds of a sunflower.
Pore Pores::Tied(int hair) const {
  const Vector3d along = part_.tied_along.normalized(), u = along.unitOrthogonal(),
                 v = along.cross(u);
  double share = (hair + 0.5) / part_.count, turn = hair * kGolden;
  if (part_.spread == Part::Spread::kRandom) {
    math::RandomStream random(seed_, StreamOf(index_, hair, Purpose::kPore));
    share = random.Uniform();
    turn = random.Uniform();
  }
  const double radius = part_.tied_radius * std::sqrt(share);
  const Vector3d root =
      *part_.tied_at + radius * (std::cos(2 * pi * turn) * u + std::sin(2 * pi * turn) * v);
  return {root, along, PolarOf(hull_, root)};
}

// Evenly over the sphere of directions, of which so many stay as the ellipsoid has area there.
Polar Pores::Random(int hair) const {
  math::RandomStream random(seed_, StreamOf(index_, hair, Purpose::kPore));
  const PoreRegion& region = part_.pores;
  const double top = std::cos(region.least_zenith), bottom = std::cos(region.greatest_zenith);
  const double least = hull_.radii.minCoeff();
  for (;;) {
    const double zenith = std::acos(random.Uniform(bottom, top));
    const double azimuth = AzimuthAt(region, azimuths_ * random.Uniform());
    const double area = DirectionOf(zenith, azimuth).cwiseQuotient(hull_.radii).norm();
    if (random.Uniform() < least * area) {
      return {std::clamp(zenith, region.least_zenith, region.greatest_zenith), azimuth};
    }
  }
}

Polar Pores::Even(int hair) const {
  const auto row = std::ranges::upper_bound(row_first_, hair) - row_first_.begin() - 1;
  const int first = row_first_[row], count = row_first_[row + 1] - first;
  // Rows begin at shares of a step that never repeat, so that no line of pores runs down the head.
  const double phase = std::fmod(static_cast<double>(row) * kGolden, 1);
  const double place = Inverse(arc_, arc_.back() * (hair - first + phase) / count);
  return {row_zenith_[row], AzimuthAt(part_.pores, azimuths_ * place)};
}

// Rows at even distances down the mean meridian, as far apart as pores in a row; each has its share
// of the area.
void Pores::LayRows() {
  const PoreRegion& region = part_.pores;
  const Vector3d& r = hull_.radii;
  arc_ = Integral([&](double share) {
    const double azimuth = region.from_azimuth + azimuths_ * share;
    return azimuths_ * std::hypot(r.x() * std::cos(azimuth), r.z() * std::sin(azimuth));
  });
  const double wide = std::sqrt((r.x() * r.x() + r.z() * r.z()) / 2);
  const double zeniths = region.greatest_zenith - region.least_zenith;
  const auto zenith = [&](double share) { return region.least_zenith + zeniths * share; };
  const auto down = [&](double share) {
    return zeniths * std::hypot(wide * std::cos(zenith(share)), r.y() * std::sin(zenith(share)));
  };
  const std::vector<double> meridian = Integral(down);
  const std::vector<double> area =
      Integral([&](double share) { return down(share) * std::sin(zenith(share)) * arc_.back(); });
  const double distance = std::sqrt(area.back() / part_.count);
  const int rows =
      static_cast<int>(std::clamp(std::round(meridian.back() / distance), 1.0, 1.0 * part_.count));
  row_first_.assign(1, 0);
  for (int row = 0; row < rows; ++row) {
    const auto at = [&](double rows_down) {
      return Inverse(meridian, meridian.back() * rows_down / rows);
    };
    row_zenith_.emplace_back(zenith(at(row + 0.5)));
    const double above = ValueAt(area, at(row + 1)) / area.back();
    row_first_.emplace_back(static_cast<int>(std::lround(part_.count * above)));
  }
  row_first_.back() = part_.count;
}

}  // namespace mane::beam
