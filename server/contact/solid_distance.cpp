#include "contact/solid_distance.h"

#include <Eigen/Geometry>

#include <cmath>
#include <utility>

#include "contact/triangle.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

// Nearer than this [m] the direction to the nearest point is rounding.
constexpr double kOnSurface = 1e-9;

// How far off a triangle its two sides are looked at, as a share of the square root of its area.
constexpr double kOffShare = 1e-3;

// Where a triangle is looked at: in the middle, then near the corners, as it may be buried in part.
constexpr double kLooks[4][3] = {
    {1. / 3, 1. / 3, 1. / 3}, {0.9, 0.05, 0.05}, {0.05, 0.9, 0.05}, {0.05, 0.05, 0.9}};

// 1 where a triangle bounds the solid and faces out of it, -1 where it faces into it, else 0.
int Facing(const WindingTree& winding, const SolidMesh& mesh, const Triangle& t) {
  const Vector3d &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
  const Vector3d area = (b - a).cross(c - a) / 2;
  const double size = area.norm();
  if (!(size > 0)) return 0;
  const Vector3d off = (kOffShare / std::sqrt(size)) * area;
  for (const auto& [u, v, w] : kLooks) {
    const Vector3d p = u * a + v * b + w * c;
    const bool front = winding.Inside(p + off), back = winding.Inside(p - off);
    if (front != back) return back ? 1 : -1;
  }
  return 0;
}

}  // namespace

SolidDistance::SolidDistance(SolidMesh mesh, exec::WorkerPool* pool, SearchBudget* budget)
    : mesh_(std::move(mesh)),
      winding_(mesh_),
      surface_(Surface(pool, budget)),
      buried_(static_cast<int>(mesh_.triangles.size() - surface_.triangles.size())),
      closest_(surface_.triangles.empty() ? nullptr
                                          : std::make_unique<ClosestTriangles>(surface_)) {}

SolidMesh SolidDistance::Surface(exec::WorkerPool* pool, SearchBudget* budget) const {
  std::vector<int> facing(mesh_.triangles.size());
  pool->ParallelFor(static_cast<int>(facing.size()), 256, [&](int begin, int end) {
    const SearchBudget::Share own_work(budget);
    for (int t = begin; t < end && !SearchBudget::Over(); ++t) {
      facing[t] = Facing(winding_, mesh_, mesh_.triangles[t]);
    }
  });
  SolidMesh surface{mesh_.vertices, {}};
  for (size_t i = 0; i < facing.size(); ++i) {
    if (facing[i] == 0) continue;
    Triangle t = mesh_.triangles[i];
    if (facing[i] < 0) std::swap(t[1], t[2]);
    surface.triangles.push_back(t);
  }
  return surface;
}

Vector3d SolidDistance::Normal(const Vector3d& point, const ClosestTriangles::Hit& hit,
                               bool inside) const {
  const Vector3d away = point - hit.point;
  if (hit.distance > kOnSurface) return (inside ? -1 : 1) * away.normalized();
  const auto& [a, b, c] = surface_.triangles[hit.triangle];
  const Vector3d& origin = surface_.vertices[a];
  return (surface_.vertices[b] - origin).cross(surface_.vertices[c] - origin).normalized();
}

Distance SolidDistance::At(const Vector3d& point, double within) const {
  const auto hit = Closest(point, within);
  const bool inside = Inside(point);
  return {inside ? -hit.distance : hit.distance, Normal(point, hit, inside)};
}

}  // namespace mane::contact
