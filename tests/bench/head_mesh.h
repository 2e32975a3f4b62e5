#pragma once

#include <Eigen/Core>

#include <cmath>
#include <numbers>

#include "groom/groom.h"

namespace mane {

/// A head of 5,000 triangles with a nose and ears, so to say: an ellipsoid with waves.
inline groom::TriangleMesh HeadMesh() {
  constexpr int kRings = 50, kSides = 50;
  groom::TriangleMesh mesh;
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j < kSides; ++j) {
      const double a = std::numbers::pi * i / kRings, b = 2 * std::numbers::pi * j / kSides;
      const double size = 1 + 0.04 * std::sin(3 * a) * std::sin(5 * b);
      mesh.vertices.emplace_back(
          (size * Eigen::Vector3d(0.078 * std::sin(a) * std::cos(b), 0.1 + 0.11 * std::cos(a),
                                  0.02 + 0.098 * std::sin(a) * std::sin(b)))
              .cast<float>());
    }
  }
  const auto add = [&](int a, int b, int c) {
    mesh.triangles.push_back(
        {static_cast<uint32_t>(a), static_cast<uint32_t>(b), static_cast<uint32_t>(c)});
  };
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < kSides; ++j) {
      const int a = i * kSides + j, b = i * kSides + (j + 1) % kSides;
      add(a, b + kSides, a + kSides), add(a, b, b + kSides);
      if (i < kRings / 2) {
        mesh.hair_triangles.push_back(static_cast<uint32_t>(mesh.triangles.size() - 1));
      }
    }
  }
  return mesh;
}

}  // namespace mane
