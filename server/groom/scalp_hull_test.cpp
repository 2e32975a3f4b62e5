// Laws of the hull that stands for a head:
//   itself     an ellipsoid is its own
//   head       of a bust it is about the skull, whatever of neck and shoulders the mesh has
//   reach      what lies above hair and within its extent counts, all else does not
//   everywhere where hair grows everywhere, all of the mesh does
//   refusal    a flat mesh and a huge one are refused by name

#include "groom/scalp_hull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace mane::groom {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const beam::Hull kSkull{Vector3d(0, 0.05, 0.01), Vector3d(0.075, 0.11, 0.095)};
constexpr int kSpokes = 48, kSkullRings = 40;

// A skull with hair on its upper half, down to the chin; below it a neck and shoulders.
TriangleMesh Bust(bool shoulders) {
  TriangleMesh mesh;
  const auto ring = [&](double x, double y, double z) {
    for (int j = 0; j < kSpokes; ++j) {
      const double f = 2 * std::numbers::pi * j / kSpokes;
      mesh.vertices.emplace_back(
          Vector3d(x * std::sin(f), y, kSkull.center.z() + z * std::cos(f)).cast<float>());
    }
  };
  for (int i = 0; i <= kSkullRings; ++i) {
    const double zenith = 0.8 * std::numbers::pi * i / kSkullRings;
    ring(kSkull.radii.x() * std::sin(zenith),
         kSkull.center.y() + kSkull.radii.y() * std::cos(zenith),
         kSkull.radii.z() * std::sin(zenith));
  }
  for (int i = 1; shoulders && i <= 60; ++i) {
    const double part = i / 60.0, wide = 0.05 + 0.17 * std::pow(part, 3);
    ring(wide, mesh.vertices[size_t{kSkullRings} * kSpokes].y() - 0.35 * part, std::min(wide, 0.1));
  }
  const auto rings = static_cast<uint32_t>(mesh.vertices.size() / kSpokes);
  for (uint32_t i = 0; i + 1 < rings; ++i) {
    for (uint32_t j = 0; j < kSpokes; ++j) {
      const uint32_t a = i * kSpokes + j, b = i * kSpokes + (j + 1) % kSpokes;
      if (i < kSkullRings / 2) mesh.hair_triangles.push_back(mesh.triangles.size());
      mesh.triangles.push_back({a, a + kSpokes, b});
      mesh.triangles.push_back({b, a + kSpokes, b + kSpokes});
    }
  }
  return mesh;
}

TEST(ScalpHullTest, OfAnEllipsoidIsItself) {
  const auto hull = ScalpHull(Ellipsoid{{0, 0.1, 0}, {0.08, 0.1, 0.09}});
  ASSERT_TRUE(hull);
  EXPECT_EQ(hull->center, Vector3d(0, 0.1, 0));
  EXPECT_EQ(hull->radii, Vector3d(0.08, 0.1, 0.09));
}

TEST(ScalpHullTest, OfABustIsAboutTheSkull) {
  for (const bool shoulders : {false, true}) {
    const auto hull = ScalpHull(Bust(shoulders));
    ASSERT_TRUE(hull);
    EXPECT_LT((hull->center - kSkull.center).norm(), 1e-4) << shoulders;
    EXPECT_LT((hull->radii - kSkull.radii).norm(), 1e-4) << shoulders;
  }
}

TEST(ScalpHullTest, WhatLiesAboveHairAndWithinItsExtentCounts) {
  TriangleMesh mesh = Bust(true);
  const auto before = ScalpHull(mesh);
  ASSERT_TRUE(before);
  mesh.vertices.emplace_back(0.0F, 0.07F, 0.17F);  // A nose, and a hand beside the head.
  mesh.vertices.emplace_back(0.4F, 0.2F, 0.0F);
  const auto same = ScalpHull(mesh);
  ASSERT_TRUE(same);
  EXPECT_EQ(same->radii, before->radii);
  mesh.vertices.emplace_back(0.0F, 0.19F, 0.0F);  // A hat.
  const auto hat = ScalpHull(mesh);
  ASSERT_TRUE(hat);
  EXPECT_LE(hat->At({0, 0.19, 0}), 1e-6);
}

TEST(ScalpHullTest, WhereHairGrowsEverywhereAllCounts) {
  TriangleMesh mesh = Bust(true);
  mesh.hair_triangles.clear();
  const auto hull = ScalpHull(mesh);
  ASSERT_TRUE(hull);
  for (const Vector3f& vertex : mesh.vertices) EXPECT_LE(hull->At(vertex.cast<double>()), 1e-6);
}

TEST(ScalpHullTest, OfAFlatMeshIsRefusedByName) {
  TriangleMesh mesh;
  for (int i = 0; i < 9; ++i) mesh.vertices.emplace_back(float(i % 3), 0.0F, float(i / 3));
  mesh.triangles = {{0, 3, 1}, {1, 3, 4}, {4, 7, 8}};
  const auto hull = ScalpHull(mesh);
  ASSERT_FALSE(hull);
  EXPECT_EQ(hull.error().field, "scalp_mesh");
}

TEST(ScalpHullTest, OfAMeshThatIsTooLargeIsRefusedByName) {
  for (const double largest : {9.9, 10.1}) {
    TriangleMesh mesh = Bust(false);
    const Vector3f center = kSkull.center.cast<float>();
    for (Vector3f& vertex : mesh.vertices) {
      vertex = static_cast<float>(largest / kSkull.radii.maxCoeff()) * (vertex - center);
    }
    const auto hull = ScalpHull(mesh);
    ASSERT_EQ(static_cast<bool>(hull), largest < 10) << largest;
    if (!hull) {
      EXPECT_EQ(hull.error().field, "scalp_mesh");
    }
  }
}

}  // namespace
}  // namespace mane::groom
