// Properties of the density field:
//   solid         1 deep inside, 0 outside, a half on the surface, for placed shapes
//   conservation  nodes times cells sum up to what was deposited, next to a head too
//   increase      what a segment would add is what its deposit adds
//   width         a fine grid shows the second moment of a full tube
//   gradient      that of finite differences
//   memory        bounded, with larger cells

#include "styling/density_field.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/random.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Obstacles kHead{{contact::Ellipsoid(Vector3d(0.07, 0.11, 0.09)),
                       {Vector3d(0.02, 0, 0), Eigen::Quaterniond(0.8, 0.6, 0, 0)}}};

DensityField Make(const Obstacles& obstacles, double cell, double radius, double size = 0.2) {
  exec::WorkerPool pool(1);
  const Vector3f half = Vector3f::Constant(static_cast<float>(size));
  auto field = DensityField::Make(BoxOver({-half, half}, cell, radius), obstacles, &pool);
  EXPECT_TRUE(field);
  return *std::move(field);
}

Vector3f RandomPoint(math::RandomStream* random, double size) {
  return Vector3d(random->Uniform(-size, size), random->Uniform(-size, size),
                  random->Uniform(-size, size))
      .cast<float>();
}

double Volume(const DensityField& field) {
  double sum = 0;
  for (const float value : field.Values()) sum += value;
  return sum * std::pow(field.box().cell, 3);
}

TEST(DensityFieldTest, TheSolidIsOneInsideAndNothingOutside) {
  const DensityField field = Make(kHead, 0.008, 0.005);
  math::RandomStream random(1, 0);
  int inside = 0, near = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3f x = RandomPoint(&random, 0.13);
    const double d = DistanceTo(kHead, x.cast<double>()).distance;
    const float rho = field.At(x);
    // A cell's diagonal is sqrt(3) cells, and its nodes mix half a cell on either side.
    if (d < -2.3 * 0.008) {
      EXPECT_EQ(rho, 1) << d;
    }
    if (d > 2.3 * 0.008) {
      EXPECT_EQ(rho, 0) << d;
    }
    inside += d < -2.3 * 0.008;
    if (std::abs(d) > 1e-4) continue;
    EXPECT_NEAR(rho, 0.5, 0.2);  // Surfaces are flat but for h^2 / (8 * 0.04 m) = 0.2 mm.
    ++near;
  }
  EXPECT_GT(inside, 500);
  EXPECT_GT(near, 10);
  // To the volume of the solid: half cells on the surface cancel.
  EXPECT_NEAR(Volume(field), 4.0 / 3 * M_PI * 0.07 * 0.11 * 0.09, 2e-5);
}

TEST(DensityFieldTest, TellsWhenTheSolidIsNear) {
  const DensityField field = Make(kHead, 0.008, 0.005);
  math::RandomStream random(2, 0);
  int far = 0;
  for (int i = 0; i < 20000; ++i) {
    const Vector3f x = RandomPoint(&random, 0.2);
    const double d = DistanceTo(kHead, x.cast<double>()).distance;
    const bool near = field.Look(x).near_solid;
    if (d < 0.002) {
      EXPECT_TRUE(near) << d;
    }
    far += !near;
  }
  EXPECT_GT(far, 15000);
}

TEST(DensityFieldTest, DepositsAddUpToTheirVolume) {
  DensityField field = Make(kHead, 0.008, 0.012);
  const double solid = Volume(field);
  math::RandomStream random(3, 0);
  double deposited = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vector3f from = RandomPoint(&random, 0.2);
    if (DistanceTo(kHead, from.cast<double>()).distance < 0) continue;
    const Vector3f to = from + RandomPoint(&random, 0.01);
    const DensityField::Segment segment{from, to, static_cast<float>(random.Uniform(0, 0.012)),
                                        static_cast<float>(random.Uniform(1e-8, 1e-6))};
    const int64_t nodes = field.Deposit(segment, field.Scale(segment));
    EXPECT_GT(nodes, 0);
    EXPECT_LT(nodes, 6 * 6 * 6);
    deposited += segment.volume;
  }
  // Float32 sums of some thousand terms at a node.
  EXPECT_NEAR(Volume(field) - solid, deposited, 1e-5 * deposited);
  const auto values = field.Values();
  for (const float value : values) EXPECT_TRUE(std::isfinite(value) && value >= 0);
}

TEST(DensityFieldTest, AnIncreaseIsWhatADepositAdds) {
  DensityField field = Make(kHead, 0.008, 0.01);
  math::RandomStream random(4, 0);
  for (int i = 0; i < 200; ++i) {
    const Vector3f from = RandomPoint(&random, 0.15);
    const DensityField::Segment segment{from, from + RandomPoint(&random, 0.01), 0.01f, 2e-7f};
    const Vector3f x = from + RandomPoint(&random, 0.01);
    const float before = field.At(x);
    const float expected = field.Increase(segment, x);
    field.Deposit(segment, field.Scale(segment));
    EXPECT_NEAR(field.At(x) - before, expected, 1e-6);
  }
}

TEST(DensityFieldTest, DensityIsTheFractionThatHairFills) {
  // A long straight wisp on a grid finer than it: on average over its full tube the density is the
  // cross-section of its strands by that of the tube.
  DensityField field = Make({}, 0.003, 0.006);
  const float length = 0.3f, radius = 0.006f, area = 1e-6f;
  const DensityField::Segment segment{
      {-length / 2, 0, 0}, {length / 2, 0, 0}, radius, area * length};
  field.Deposit(segment, field.Scale(segment));
  double moment = 0, sum = 0;
  for (int i = 0; i < 60; ++i) {
    for (int j = 0; j < 60; ++j) {
      const float y = -0.015f + 0.0005f * (static_cast<float>(i) + 0.5f);
      const float z = -0.015f + 0.0005f * (static_cast<float>(j) + 0.5f);
      const float rho = field.At({0.001f, y, z});
      sum += rho * 2.5e-7;
      moment += rho * 2.5e-7 * (y * y + z * z);
    }
  }
  // Ends are rounded: the kernel's half spheres take 8/15 R^3 pi / (R^2/2 pi L) of it, 1.6 % each.
  EXPECT_NEAR(sum / area, 1, 0.04);
  // r^2/2, and what interpolation widens: h^2/6 along each axis.
  EXPECT_NEAR(moment / sum, radius * radius / 2 + 0.003 * 0.003 / 3, 1e-6);
}

TEST(DensityFieldTest, SlopesAreThoseOfFiniteDifferences) {
  DensityField field = Make(kHead, 0.008, 0.01);
  math::RandomStream random(5, 0);
  for (int i = 0; i < 3000; ++i) {
    const Vector3f from = RandomPoint(&random, 0.15);
    const DensityField::Segment segment{from, from + RandomPoint(&random, 0.01), 0.01f, 1e-6f};
    field.Deposit(segment, field.Scale(segment));
  }
  int compared = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vector3f x = RandomPoint(&random, 0.15);
    // Differences stay in a cell, where the density is linear along each axis: only rounding of
    // values near 1 is left, 1e-7 / 1e-3.
    const float e = 5e-4f;
    const Vector3f share = field.Look(x).fraction;
    if (share.minCoeff() < 0.1f || share.maxCoeff() > 0.9f) continue;
    const Vector3f slope = field.SlopeAt(x);
    for (int a = 0; a < 3; ++a) {
      const Vector3f step = e * Vector3f::Unit(a);
      const float difference = (field.At(x + step) - field.At(x - step)) / (2 * e);
      EXPECT_NEAR(slope[a], difference, 2e-3 + 1e-3 * std::abs(slope[a]));
    }
    ++compared;
  }
  EXPECT_GT(compared, 300);
}

TEST(DensityFieldTest, MemoryIsBoundedByLargerCells) {
  const Vector3f half = Vector3f::Constant(2);
  const GridBox large = BoxOver({-half, half}, 0.008, 0.01);
  EXPECT_LE(large.count(), 4'000'000u);
  EXPECT_GT(large.count(), 3'500'000u);
  EXPECT_GT(large.cell, 0.02f);
  const Vector3f small = Vector3f::Constant(0.1f);
  EXPECT_EQ(BoxOver({-small, small}, 0.008, 0.01).cell, 0.008f);
  EXPECT_EQ(BoxOver({-small, small}, 0.008, 0.03).cell, 0.015f);
  const GridBox box = BoxOver({-small, small}, 0.008, 0);
  EXPECT_TRUE((box.low.array() < -0.1f).all());
  const Vector3f high = box.low + box.cell * (box.nodes.cast<float>() - Vector3f::Ones());
  EXPECT_TRUE((high.array() > 0.1f).all());
}

TEST(DensityFieldTest, StopsWhenNobodyWaits) {
  exec::WorkerPool pool(1);
  const Vector3f half = Vector3f::Constant(0.2f);
  const auto field =
      DensityField::Make(BoxOver({-half, half}, 0.008, 0), kHead, &pool, [] { return true; });
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, ErrorCode::kCancelled);
}

}  // namespace
}  // namespace mane::styling
