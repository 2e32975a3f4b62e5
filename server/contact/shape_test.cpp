// Shapes as one type: each answers as itself, and one that is out of range is refused by name.

#include "contact/shape.h"

#include <gtest/gtest.h>

#include <limits>

#include "contact/test_meshes.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

TEST(ShapeTest, EveryKindAnswersAsItself) {
  exec::WorkerPool pool(2);
  const auto field = MeshField::Build(fixtures::Sphere(4, 0.1), {}, &pool);
  ASSERT_TRUE(field);
  const BodyShape shapes[] = {Ellipsoid(Vector3d::Constant(0.1)),
                              Capsule(Vector3d::Zero(), Vector3d::Zero(), 0.1), *field};
  const float x[] = {0.15F, 0.02F}, y[] = {0, 0.03F}, z[] = {0, 0};
  for (const BodyShape& shape : shapes) {
    ASSERT_TRUE(Validate(shape));
    float d[2], nx[2], ny[2], nz[2];
    At(shape, {x, y, z}, {d, nx, ny, nz});
    for (int i = 0; i < 2; ++i) {
      const Vector3d p(x[i], y[i], z[i]);
      EXPECT_NEAR(d[i], p.norm() - 0.1, 5e-4) << shape.index();
      EXPECT_NEAR(At(shape, p).distance, d[i], 1e-6) << shape.index();
      EXPECT_GT(Vector3d(nx[i], ny[i], nz[i]).dot(p.normalized()), 0.99) << shape.index();
    }
  }
}

TEST(ShapeTest, RefusesWhatIsOutOfRangeByName) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto field = [](const BodyShape& shape) {
    const auto checked = Validate(shape);
    return checked ? std::string("none") : checked.error().field;
  };
  EXPECT_EQ(field(Ellipsoid({0.1, 0, 0.1})), "radii.y");
  EXPECT_EQ(field(Ellipsoid({0.1, 0.1, nan})), "radii.z");
  EXPECT_EQ(field(Ellipsoid({0.001, 0.1, 0.2})), "radii");
  EXPECT_EQ(field(Capsule({0, nan, 0}, {0, 0, 1}, 0.1)), "a");
  EXPECT_EQ(field(Capsule({0, 0, 0}, {0, 0, 1001}, 0.1)), "b");
  EXPECT_EQ(field(Capsule({0, 0, 0}, {0, 0, 1}, -0.1)), "radius");
  EXPECT_EQ(field(Capsule({0, 0, 0}, {0, 0, 1}, 0.1)), "none");
}

}  // namespace
}  // namespace mane::contact
