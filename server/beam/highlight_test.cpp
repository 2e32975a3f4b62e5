// The highlight is the brightest that Blinn's model gives for the normals of a cylinder; its
// limits.

#include "beam/highlight.h"

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <cmath>
#include <numbers>

#include "beam/test_random.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;

TEST(HighlightTest, IsTheBrightestOfACylindersNormals) {
  fixtures::Random random(12);
  for (int i = 0; i < 200; ++i) {
    const Vector3d T = random.Direction(), L = random.Direction(), V = random.Direction();
    const Shine shine{.specular = 0.7, .exponent = random.Uniform(0, 60)};
    const Vector3d H = (L + V).normalized(), u = T.unitOrthogonal(), v = T.cross(u);
    double brightest = 0;
    for (int k = 0; k < 20'000; ++k) {
      const double a = 2 * std::numbers::pi * k / 20'000;
      const double cosine = std::max(0.0, (std::cos(a) * u + std::sin(a) * v).dot(H));
      brightest = std::max(brightest, 0.7 * std::pow(cosine, shine.exponent));
    }
    EXPECT_NEAR(Specular(T, L, V, shine), brightest, 1e-5);
  }
}

TEST(HighlightTest, HasNoSide) {
  fixtures::Random random(13);
  const Vector3d T = random.Direction(), L = random.Direction(), V = random.Direction();
  EXPECT_DOUBLE_EQ(Specular(T, L, V, {}), Specular(-T, L, V, {}));
  EXPECT_DOUBLE_EQ(Specular(T, L, V, {}), Specular(T, V, L, {}));
}

TEST(HighlightTest, Limits) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  const Shine shine{.specular = 0.7, .exponent = 10};
  EXPECT_DOUBLE_EQ(Specular(x, y, y, shine), 0.7);  // Across.
  EXPECT_EQ(Specular(y, y, y, shine), 0);           // Along H.
  EXPECT_EQ(Specular(x, z, -z, shine), 0);          // No H.
  const Shine flat{.specular = 0.7, .exponent = 0};
  EXPECT_DOUBLE_EQ(Specular(x, y, (x + z).normalized(), flat), 0.7);
  EXPECT_EQ(Specular(x, z, -z, flat), 0);
  EXPECT_EQ(Specular(x, z, (-z + 1e-9 * x).normalized(), shine), 0);
}

TEST(HighlightTest, AddsTheAmbientLight) {
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY();
  const Shine shine{2, 0.25, 3, 0.5, 10};
  const Highlight highlight = HighlightOf(x, y, y, shine, 1.5);
  EXPECT_DOUBLE_EQ(highlight.ambient, 2 * 0.25 * 1.5);
  EXPECT_DOUBLE_EQ(highlight.specular, 3 * 0.5);
  EXPECT_DOUBLE_EQ(highlight.total(), 0.75 + 1.5);
}

}  // namespace
}  // namespace mane::beam
