#include "styling/force_field.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "groom/range.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;

constexpr long kMostTerms = 64;
constexpr int kMostNodes = 512;  // Of a grid, along an axis.
constexpr groom::Range kStrength{-1000, 1000};
constexpr groom::Range kCenter{-100, 100, "m"};
constexpr groom::Range kRadius{0, 100, "m"};
constexpr groom::Range kDirection{-1e6, 1e6};
constexpr groom::Range kDirectionLength{1e-6, 1e6};
constexpr groom::Range kCell{0, 10, "m", true};
constexpr groom::Range kNodes{2, kMostNodes};

// Forces with a centre vanish there smoothly, within about this distance [m] (D2).
constexpr double kCore = 1e-3;
constexpr double kRounding = 1e-9;  // Of a place on a grid, in cells: its last nodes belong to it.

bool HasDirection(FieldTerm::Kind kind) {
  return kind == FieldTerm::Kind::kUniform || kind == FieldTerm::Kind::kVortex;
}

Result<void> CheckNumber(const std::string& field, double value, const groom::Range& range) {
  if (range.Contains(value)) return {};
  return groom::OutOfRange(field, value, range);
}

Result<void> Validate(const FieldTerm::Grid& grid, const std::string& field) {
  if (auto low = groom::CheckVector(field + ".low", grid.low, kCenter); !low) return low;
  if (auto cell = CheckNumber(field + ".cell_m", grid.cell, kCell); !cell) return cell;
  const auto nodes = groom::CheckVector(field + ".nodes", grid.nodes.cast<double>(), kNodes);
  if (!nodes) return nodes;
  const auto expected = grid.nodes.cast<size_t>().prod();
  const std::string name = field + ".values";
  if (grid.values.size() != expected) {
    return InvalidArgument(
        name, fmt::format("{} has {} vectors; {} x {} x {} nodes need {}", name, grid.values.size(),
                          grid.nodes.x(), grid.nodes.y(), grid.nodes.z(), expected));
  }
  for (size_t i = 0; i < expected; ++i) {
    const Vector3d value = grid.values[i].cast<double>();
    const auto bounded = groom::CheckVector(fmt::format("{}[{}]", name, i), value, kStrength);
    if (!bounded) return bounded;
  }
  return {};
}

Result<void> Validate(const FieldTerm& term, const std::string& field) {
  if (term.kind < FieldTerm::Kind::kUniform || term.kind > FieldTerm::Kind::kGrid) {
    return InvalidArgument(field + ".kind", field + ".kind is none of the kinds of field terms");
  }
  if (auto size = CheckNumber(field + ".strength", term.strength, kStrength); !size) return size;
  if (auto center = groom::CheckVector(field + ".center", term.center, kCenter); !center) {
    return center;
  }
  if (auto radius = CheckNumber(field + ".radius_m", term.radius, kRadius); !radius) return radius;
  if (HasDirection(term.kind)) {
    const std::string name = field + ".direction";
    if (auto finite = groom::CheckVector(name, term.direction, kDirection); !finite) return finite;
    const auto length = CheckNumber(name, term.direction.norm(), kDirectionLength);
    if (!length) return length;
  }
  if (term.kind != FieldTerm::Kind::kGrid) return {};
  if (term.grid == nullptr) {
    return InvalidArgument(field + ".grid", field + ".grid is missing");
  }
  return Validate(*term.grid, field + ".grid");
}

// 1 within `radius`, 0 beyond twice that, smooth between (D3).
double Fade(double distance, double radius) {
  if (radius == 0 || distance <= radius) return 1;
  const double u = distance / radius - 1;
  return u >= 1 ? 0 : 1 - u * u * (3 - 2 * u);
}

Vector3d Interpolate(const FieldTerm::Grid& grid, const Vector3d& x) {
  const Vector3d place = (x - grid.low) / grid.cell;
  const Vector3d last = (grid.nodes.array() - 1).cast<double>();
  if (!(place.array() >= -kRounding).all() || !(place.array() <= last.array() + kRounding).all()) {
    return Vector3d::Zero();
  }
  const Eigen::Vector3i cell =
      place.cast<int>().cwiseMax(0).cwiseMin(grid.nodes - Eigen::Vector3i(2, 2, 2));
  const Vector3d f = place - cell.cast<double>();
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < 8; ++k) {
    const Eigen::Vector3i i(k & 1, k >> 1 & 1, k >> 2);
    double weight = 1;
    for (int a = 0; a < 3; ++a) weight *= i[a] == 1 ? f[a] : 1 - f[a];
    const Eigen::Vector3i node = cell + i;
    const auto row = static_cast<size_t>(node.z()) * grid.nodes.y() + node.y();
    sum += weight * grid.values[row * grid.nodes.x() + node.x()].cast<double>();
  }
  return sum;
}

// A term without its strength and fade (D1, D2).
Vector3d Shape(const FieldTerm& term, const Vector3d& offset, const Vector3d& x) {
  const auto smooth_unit = [](const Vector3d& v) -> Vector3d {
    return v / std::sqrt(v.squaredNorm() + kCore * kCore);
  };
  switch (term.kind) {
    case FieldTerm::Kind::kUniform:
      return term.direction;
    case FieldTerm::Kind::kPulledBack:
      return -smooth_unit(offset);
    case FieldTerm::Kind::kRadial:
      return smooth_unit(offset);
    case FieldTerm::Kind::kVortex:
      return smooth_unit(term.direction.cross(offset));
    case FieldTerm::Kind::kGrid:
      return Interpolate(*term.grid, x);
  }
  return Vector3d::Zero();
}

}  // namespace

Result<void> Validate(const std::vector<FieldTerm>& terms, const std::string& field) {
  const auto count = static_cast<long>(terms.size());
  if (count > kMostTerms) return groom::TooMany(field, "terms", count, kMostTerms);
  for (size_t i = 0; i < terms.size(); ++i) {
    if (auto term = Validate(terms[i], fmt::format("{}[{}]", field, i)); !term) return term;
  }
  return {};
}

ForceField::ForceField(std::vector<FieldTerm> terms) : terms_(std::move(terms)) {
  for (FieldTerm& term : terms_) {
    if (HasDirection(term.kind)) term.direction.normalize();
  }
}

Vector3d ForceField::At(const Vector3d& x) const {
  Vector3d phi = Vector3d::Zero();
  for (const FieldTerm& term : terms_) {
    const Vector3d offset = x - term.center;
    double fade = 1;
    if (term.radius > 0) {
      const bool axis = term.kind == FieldTerm::Kind::kVortex;
      fade = Fade(axis ? term.direction.cross(offset).norm() : offset.norm(), term.radius);
      if (fade == 0) continue;
    }
    phi += term.strength * fade * Shape(term, offset, x);
  }
  return phi;
}

std::vector<Eigen::Vector3f> ForceField::Sample(const Vector3d& low, double cell,
                                                const Eigen::Vector3i& nodes) const {
  std::vector<Eigen::Vector3f> values;
  values.reserve(nodes.cast<size_t>().prod());
  for (int z = 0; z < nodes.z(); ++z) {
    for (int y = 0; y < nodes.y(); ++y) {
      for (int x = 0; x < nodes.x(); ++x) {
        values.emplace_back(At(low + cell * Vector3d(x, y, z)).cast<float>());
      }
    }
  }
  return values;
}

}  // namespace mane::styling
