#include "groom/hair_region.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/check.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr int kCells = 128;  // Of an ellipsoid, in each direction.
constexpr double kAzimuthStep = 2 * std::numbers::pi / kCells;

}  // namespace

HairRegion::HairRegion(const Scalp& scalp)
    : mesh_(std::get_if<TriangleMesh>(&scalp)), ellipsoid_(std::get_if<Ellipsoid>(&scalp)) {
  if (ellipsoid_ != nullptr) AddCells();
  if (mesh_ == nullptr) return;
  if (mesh_->hair_triangles.empty()) {
    for (uint32_t t = 0; t < mesh_->triangles.size(); ++t) AddTriangle(t);
  } else {
    for (const uint32_t t : mesh_->hair_triangles) AddTriangle(t);
  }
}

void HairRegion::Add(double area) {
  areas_.push_back(area);
  choice_.Add(area);
}

ScalpPoint HairRegion::At(int patch, double s, double t) const {
  if (mesh_ != nullptr) return OnTriangle(patch, s, t);
  const Vector3d n = Normal(patch, s, t);
  const Vector3d support = ellipsoid_->radii.cwiseProduct(n);
  return {ellipsoid_->center + ellipsoid_->radii.cwiseProduct(support) / support.norm(), n, -1};
}

ScalpPoint HairRegion::Draw(math::RandomStream& random) const {
  MANE_CHECK(!areas_.empty());
  const int patch = choice_.Choose(random);
  const double s = random.Uniform(), t = random.Uniform();
  return At(patch, s, t);
}

Vector3d HairRegion::Corner(uint32_t triangle, int k) const {
  return mesh_->vertices[mesh_->triangles[triangle][k]].cast<double>();
}

void HairRegion::AddTriangle(uint32_t triangle) {
  const Vector3d a = Corner(triangle, 0);
  const double area = 0.5 * (Corner(triangle, 1) - a).cross(Corner(triangle, 2) - a).norm();
  if (area == 0) return;
  triangles_.push_back(triangle);
  Add(area);
}

ScalpPoint HairRegion::OnTriangle(int patch, double s, double t) const {
  const uint32_t triangle = triangles_[patch];
  // The square root makes up for the triangle's narrowing toward the first corner.
  const double root = std::sqrt(s);
  const Vector3d a = Corner(triangle, 0), b = Corner(triangle, 1), c = Corner(triangle, 2);
  const Vector3d position = (1 - root) * a + root * (1 - t) * b + root * t * c;
  return {position, (b - a).cross(c - a).normalized(), static_cast<int>(triangle)};
}

// The cap of an ellipsoid, over the sphere of its outward normals n, where it is a spherical cap:
// position = (a^2 n_x, b^2 n_y, c^2 n_z) / h with h^2 = a^2 n_x^2 + b^2 n_y^2 + c^2 n_z^2, and the
// area per solid angle is 1 / K = (a b c)^2 / h^4, K being the Gaussian curvature. Cells of equal
// solid angle: even in azimuth and in drop = 1 - cos(polar angle).
void HairRegion::AddCells() {
  to_cap_ =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitY(), ellipsoid_->cap_axis.normalized());
  const double half_sine = std::sin(0.5 * ellipsoid_->cap_angle);
  drop_step_ = 2 * half_sine * half_sine / kCells;
  for (int i = 0; i < kCells * kCells; ++i) {
    const Vector3d support = ellipsoid_->radii.cwiseProduct(Normal(i, 0.5, 0.5));
    const double ratio = ellipsoid_->radii.prod() / support.squaredNorm();
    Add(ratio * ratio * drop_step_ * kAzimuthStep);
  }
}

// Normal at the fractions s and t across a cell.
Vector3d HairRegion::Normal(int cell, double s, double t) const {
  const int row = cell / kCells, column = cell % kCells;
  const double drop = (row + s) * drop_step_;
  const double azimuth = (column + t) * kAzimuthStep;
  const double sine = std::sqrt(std::max(drop * (2 - drop), 0.0));
  return to_cap_ * Vector3d(sine * std::cos(azimuth), 1 - drop, sine * std::sin(azimuth));
}

}  // namespace mane::groom
