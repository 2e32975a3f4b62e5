#include "styling/chart.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "base/check.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kFarthest = 4;  // Of the fitted centre, in rms radii of the region (P2).
constexpr double kFlattest =
    1e-6;  // Part of the rms radius squared, below which nothing is fitted.

// Calls visit(corners, area vector) for every hair triangle.
template <typename Visit>
void ForHairTriangles(const groom::TriangleMesh& mesh, const Visit& visit) {
  const size_t n = mesh.hair_triangles.empty() ? mesh.triangles.size() : mesh.hair_triangles.size();
  for (size_t i = 0; i < n; ++i) {
    const auto& triangle = mesh.triangles[mesh.hair_triangles.empty() ? i : mesh.hair_triangles[i]];
    std::array<Vector3d, 3> x;
    for (int k = 0; k < 3; ++k) x[k] = mesh.vertices[triangle[k]].cast<double>();
    visit(x, 0.5 * (x[1] - x[0]).cross(x[2] - x[0]));
  }
}

// (P1) and (P2), with their letters.
Vector3d CenterOf(const groom::TriangleMesh& mesh) {
  double area = 0;
  Vector3d mean = Vector3d::Zero(), a = Vector3d::Zero();
  ForHairTriangles(mesh, [&](const std::array<Vector3d, 3>& x, const Vector3d& normal) {
    area += normal.norm();
    a += normal;
    mean += normal.norm() / 3 * (x[0] + x[1] + x[2]);
  });
  MANE_CHECK(area > 0);
  mean /= area;
  a /= area;

  Eigen::Matrix3d C = Eigen::Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  ForHairTriangles(mesh, [&](const std::array<Vector3d, 3>& x, const Vector3d& normal) {
    const double w = normal.norm() / (3 * area);
    for (const Vector3d& corner : x) {
      const Vector3d y = corner - mean;
      C += w * y * y.transpose();
      b += 0.5 * w * y.squaredNorm() * y;
    }
  });

  const double s = std::sqrt(C.trace());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(C);
  if (eigen.eigenvalues()[0] > kFlattest * s * s) {
    const Eigen::Matrix3d& V = eigen.eigenvectors();
    const Vector3d c = V * (V.transpose() * b).cwiseQuotient(eigen.eigenvalues());
    if (c.norm() <= kFarthest * s && c.dot(a) <= 0.1 * s) return mean + c;
  }
  const Vector3d outward = a.norm() > 1e-3 ? a.normalized() : Vector3d(Vector3d::UnitY());
  return mean - kFarthest * s * outward;
}

}  // namespace

ScalpChart::ScalpChart(const groom::Scalp& scalp) {
  if (const auto* mesh = std::get_if<groom::TriangleMesh>(&scalp)) {
    center_ = CenterOf(*mesh);
    return;
  }
  const auto* ellipsoid = std::get_if<groom::Ellipsoid>(&scalp);
  MANE_CHECK(ellipsoid != nullptr);
  center_ = ellipsoid->center;
}

Angles ScalpChart::At(const Vector3d& point) const {
  // Adding +0 turns -0 into it: atan2 tells them apart, by half a turn.
  const Vector3d d = (point - center_).array() + 0.0;
  return {std::atan2(std::hypot(d.x(), d.z()), d.y()),
          d.x() == 0 && d.z() == 0 ? 0 : std::atan2(d.x(), d.z())};
}

Vector3d DirectionOf(const Angles& angles) {
  const double sine = std::sin(angles.polar);
  return {sine * std::sin(angles.azimuth), std::cos(angles.polar), sine * std::cos(angles.azimuth)};
}

ImagePoint ToImage(const Angles& angles) {
  const double radius = angles.polar / (2 * pi);
  return {0.5 + radius * std::sin(angles.azimuth), 0.5 + radius * std::cos(angles.azimuth)};
}

Angles FromImage(const ImagePoint& point) {
  const double x = (point.u - 0.5) + 0.0, z = (point.v - 0.5) + 0.0;
  return {std::min(2 * pi * std::hypot(x, z), pi), x == 0 && z == 0 ? 0 : std::atan2(x, z)};
}

}  // namespace mane::styling
