#include "groom/sampler.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "base/check.h"
#include "groom/blue_noise.h"
#include "math/random.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr uint64_t kSamplerStream = std::numeric_limits<uint64_t>::max();  // No guide's index.
constexpr int kCandidatesPerPoint = 10;
constexpr int kFewestCandidates = 200;

// Chooses among items in proportion to their weights, all positive.
class WeightedChoice {
 public:
  void Add(double weight) { sums_.push_back(total() + weight); }
  [[nodiscard]] double total() const { return sums_.empty() ? 0 : sums_.back(); }
  [[nodiscard]] int Choose(math::RandomStream& random) const {
    const auto at = std::ranges::upper_bound(sums_, random.Uniform() * total());
    return static_cast<int>(std::min<ptrdiff_t>(at - sums_.begin(), std::ssize(sums_) - 1));
  }

 private:
  std::vector<double> sums_;
};

// Hair triangles of a mesh that have an area.
class MeshRegion {
 public:
  explicit MeshRegion(const TriangleMesh& mesh) : mesh_(mesh) {
    if (mesh.hair_triangles.empty()) {
      for (uint32_t t = 0; t < mesh.triangles.size(); ++t) Add(t);
    } else {
      for (const uint32_t t : mesh.hair_triangles) Add(t);
    }
  }

  [[nodiscard]] double area() const { return choice_.total(); }

  ScalpPoint Draw(math::RandomStream& random) const {
    const uint32_t t = triangles_[choice_.Choose(random)];
    // Uniform in the triangle: the square root makes up for its narrowing toward the first corner.
    const double s = std::sqrt(random.Uniform()), u = random.Uniform();
    const Vector3d a = Corner(t, 0), b = Corner(t, 1), c = Corner(t, 2);
    const Vector3d position = (1 - s) * a + s * (1 - u) * b + s * u * c;
    return {position, (b - a).cross(c - a).normalized(), static_cast<int>(t)};
  }

 private:
  [[nodiscard]] Vector3d Corner(uint32_t t, int k) const {
    return mesh_.vertices[mesh_.triangles[t][k]].cast<double>();
  }
  void Add(uint32_t t) {
    const Vector3d a = Corner(t, 0);
    const double area = 0.5 * (Corner(t, 1) - a).cross(Corner(t, 2) - a).norm();
    if (area == 0) return;
    triangles_.push_back(t);
    choice_.Add(area);
  }

  const TriangleMesh& mesh_;
  std::vector<uint32_t> triangles_;
  WeightedChoice choice_;
};

// The cap of an ellipsoid, over the sphere of its outward normals n, where it is a spherical cap:
// position = (a^2 n_x, b^2 n_y, c^2 n_z) / h with h^2 = a^2 n_x^2 + b^2 n_y^2 + c^2 n_z^2, and the
// area per solid angle is 1 / K = (a b c)^2 / h^4, K being the Gaussian curvature. Cells of equal
// solid angle: even in azimuth and in drop = 1 - cos(polar angle).
class EllipsoidRegion {
 public:
  explicit EllipsoidRegion(const Ellipsoid& ellipsoid)
      : ellipsoid_(ellipsoid),
        to_cap_(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(),
                                                   ellipsoid.cap_axis.normalized())) {
    const double half_sine = std::sin(0.5 * ellipsoid.cap_angle);
    drop_step_ = 2 * half_sine * half_sine / kCells;
    for (int i = 0; i < kCells * kCells; ++i) {
      const Vector3d n = Normal(i, 0.5, 0.5);
      const double ratio = ellipsoid.radii.prod() / Support(n).squaredNorm();
      choice_.Add(ratio * ratio * drop_step_ * kAzimuthStep);
    }
  }

  [[nodiscard]] double area() const { return choice_.total(); }

  ScalpPoint Draw(math::RandomStream& random) const {
    const int cell = choice_.Choose(random);
    const double u = random.Uniform(), v = random.Uniform();
    const Vector3d n = Normal(cell, u, v);
    const Vector3d support = Support(n);
    return {ellipsoid_.center + ellipsoid_.radii.cwiseProduct(support) / support.norm(), n, -1};
  }

 private:
  static constexpr int kCells = 128;  // In each direction.
  static constexpr double kAzimuthStep = 2 * std::numbers::pi / kCells;

  // Normal at the fractions u and v across cell `i`.
  [[nodiscard]] Vector3d Normal(int i, double u, double v) const {
    const int row = i / kCells, column = i % kCells;
    const double drop = (row + u) * drop_step_;
    const double azimuth = (column + v) * kAzimuthStep;
    const double sine = std::sqrt(std::max(drop * (2 - drop), 0.0));
    return to_cap_ * Vector3d(sine * std::cos(azimuth), 1 - drop, sine * std::sin(azimuth));
  }
  [[nodiscard]] Vector3d Support(const Vector3d& n) const {
    return ellipsoid_.radii.cwiseProduct(n);
  }

  const Ellipsoid& ellipsoid_;
  Eigen::Quaterniond to_cap_;  // Takes +Y to the cap's axis.
  double drop_step_;
  WeightedChoice choice_;
};

template <typename Region>
std::vector<ScalpPoint> Sample(const Region& region, int n, uint64_t seed) {
  math::RandomStream random(seed, kSamplerStream);
  const int m = std::max(kCandidatesPerPoint * n, kFewestCandidates);
  std::vector<ScalpPoint> candidates;
  std::vector<Vector3d> positions;
  candidates.reserve(m);
  positions.reserve(m);
  for (int i = 0; i < m; ++i) {
    candidates.push_back(region.Draw(random));
    positions.push_back(candidates.back().position);
  }
  std::vector<ScalpPoint> points;
  points.reserve(n);
  for (const int i : EliminateToBlueNoise(positions, n, region.area())) {
    points.push_back(candidates[i]);
  }
  return points;
}

}  // namespace

double HairArea(const Scalp& scalp) {
  if (const auto* mesh = std::get_if<TriangleMesh>(&scalp)) return MeshRegion(*mesh).area();
  if (const auto* ellipsoid = std::get_if<Ellipsoid>(&scalp)) {
    return EllipsoidRegion(*ellipsoid).area();
  }
  return 0;
}

std::vector<ScalpPoint> SampleScalp(const Scalp& scalp, int n, uint64_t seed) {
  MANE_CHECK(n >= 1);
  if (const auto* mesh = std::get_if<TriangleMesh>(&scalp)) {
    return Sample(MeshRegion(*mesh), n, seed);
  }
  const auto* ellipsoid = std::get_if<Ellipsoid>(&scalp);
  MANE_CHECK(ellipsoid != nullptr);
  return Sample(EllipsoidRegion(*ellipsoid), n, seed);
}

}  // namespace mane::groom
