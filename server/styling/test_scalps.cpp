#include "styling/test_scalps.h"

#include <cmath>
#include <numbers>

namespace mane::styling {

groom::TriangleMesh Dome(const Eigen::Vector3d& center, double angle, int rings) {
  groom::TriangleMesh mesh;
  const auto sectors = static_cast<uint32_t>(3 * rings);
  const auto add = [&](double polar, double azimuth) {
    const Eigen::Vector3d n(std::sin(polar) * std::sin(azimuth), std::cos(polar),
                            std::sin(polar) * std::cos(azimuth));
    mesh.vertices.push_back((center + kDomeRadius * n).cast<float>());
  };
  add(0, 0);
  for (int ring = 1; ring <= rings; ++ring) {
    for (uint32_t i = 0; i < sectors; ++i) {
      add(angle * ring / rings, 2 * std::numbers::pi * i / sectors);
    }
  }
  for (uint32_t i = 0; i < sectors; ++i) {
    const uint32_t next = (i + 1) % sectors;
    mesh.triangles.push_back({0, 1 + i, 1 + next});
    for (uint32_t ring = 1; ring < uint32_t(rings); ++ring) {
      const uint32_t inner = 1 + (ring - 1) * sectors, outer = inner + sectors;
      mesh.triangles.push_back({inner + i, outer + i, outer + next});
      mesh.triangles.push_back({inner + i, outer + next, inner + next});
    }
  }
  return mesh;
}

groom::TriangleMesh Square(int k) {
  groom::TriangleMesh mesh;
  for (int i = 0; i <= k; ++i) {
    for (int j = 0; j <= k; ++j) mesh.vertices.emplace_back(float(i) / k, 0, float(j) / k);
  }
  for (uint32_t i = 0; i < uint32_t(k); ++i) {
    for (uint32_t j = 0; j < uint32_t(k); ++j) {
      const uint32_t a = i * (k + 1) + j, b = a + k + 1;
      mesh.triangles.push_back({a, a + 1, b});
      mesh.triangles.push_back({b, a + 1, b + 1});
    }
  }
  return mesh;
}

groom::Ellipsoid Head() { return {{0.01, 0.02, -0.03}, {0.078, 0.11, 0.098}, {0.1, 1, -0.2}, 1.3}; }

}  // namespace mane::styling
