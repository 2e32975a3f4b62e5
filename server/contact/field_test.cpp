// Properties of fields built from meshes:
//   order        the sphere mesh's field converges to the sphere at second order in its edges
//   bound        |interpolated - exact| within the band keeps the tolerance, for every tolerance
//   eikonal      distances grow by one per metre along the normal, away from folds
//   smooth       distance and normal have no steps; a point slid over the surface sees no jump
//   anywhere     deep inside the normal leads out; outside the grid distances go on
//   solids       torus, box, nested and overlapping components, a small hole
//   bits         the same for any number of workers; queries allocate nothing

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "base/test_allocations.h"
#include "contact/mesh_field.h"
#include "contact/repair.h"
#include "contact/solid_distance.h"
#include "contact/test_meshes.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;

class FieldTest : public ::testing::Test {
 protected:
  std::shared_ptr<const MeshField> Build(const TriangleMesh& mesh,
                                         const FieldOptions& options = {}) {
    auto field = MeshField::Build(mesh, options, &pool_);
    EXPECT_TRUE(field) << (field ? "" : field.error().message);
    return field ? *field : nullptr;
  }
  SolidDistance Exact(const TriangleMesh& mesh) {
    MeshReport report;
    return {*Repair(mesh, {}, &report), &pool_};
  }
  Vector3d Point(double reach) { return reach * Vector3d(sym_(rng_), sym_(rng_), sym_(rng_)); }
  Vector3d Direction() { return Point(1).normalized(); }

  exec::WorkerPool pool_{2};
  std::mt19937_64 rng_{20240123};
  std::uniform_real_distribution<double> sym_{-1, 1};
};

TEST_F(FieldTest, ASphereMeshConvergesToTheSphereAtSecondOrder) {
  FieldOptions options;
  options.tolerance = 1e-4;
  double last = 0;
  for (const int level : {1, 2, 3}) {
    const auto field = Build(fixtures::Sphere(level, 0.1), options);
    double worst = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vector3d p = (0.1 + 0.008 * std::abs(sym_(rng_))) * Direction();
      worst = std::max(worst, std::abs(field->At(p).distance - (p.norm() - 0.1)));
    }
    if (level > 1) {
      EXPECT_NEAR(last / worst, 4, 0.6) << level;
    }
    last = worst;
  }
}

TEST_F(FieldTest, ErrorsInTheBandKeepTheTolerance) {
  const TriangleMesh meshes[] = {fixtures::Sphere(2, 0.1), fixtures::Torus(0.1, 0.03, 60, 30),
                                 fixtures::Box({-0.1, -0.05, -0.004}, {0.1, 0.05, 0.004})};
  for (const TriangleMesh& mesh : meshes) {
    const SolidDistance exact = Exact(mesh);
    for (const double tolerance : {1e-3, 3e-4}) {
      FieldOptions options;
      options.tolerance = tolerance;
      const auto field = Build(mesh, options);
      EXPECT_GT(field->max_error(), 0);
      EXPECT_LT(field->max_error(), 1.7 * tolerance);
      double worst = 0;
      for (int i = 0; i < 20000; ++i) {
        const Vector3d p = Point(0.15);
        const double d = exact.At(p).distance;
        if (std::abs(d) > options.band) continue;
        worst = std::max(worst, std::abs(field->At(p).distance - d));
      }
      EXPECT_LT(worst, 1.7 * tolerance);  // 0.5 mm at the default.
    }
  }
}

TEST_F(FieldTest, BeyondTheBandErrorsGrowByATenthOfTheWay) {
  const TriangleMesh mesh = fixtures::Torus(0.1, 0.03, 60, 30);
  const SolidDistance exact = Exact(mesh);
  const auto field = Build(mesh);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = Point(i % 2 ? 0.2 : 1);
    const double d = exact.At(p).distance;
    EXPECT_NEAR(field->At(p).distance, d, 5e-4 + 0.15 * std::max(0.0, std::abs(d) - 0.01));
    if (std::abs(d) > 5e-4) {
      EXPECT_EQ(field->At(p).distance < 0, d < 0) << d;
    }
  }
}

TEST_F(FieldTest, DistancesGrowByOneAlongTheNormal) {
  const auto field = Build(fixtures::Sphere(5, 0.1));
  for (int i = 0; i < 3000; ++i) {
    const Vector3d p = (0.1 + 0.03 * sym_(rng_)) * Direction();
    const Distance at = field->At(p);
    EXPECT_NEAR(at.normal.norm(), 1, 1e-6);
    const double h = 5e-4;
    const double slope =
        (field->At(p + h * at.normal).distance - field->At(p - h * at.normal).distance) / (2 * h);
    EXPECT_NEAR(slope, 1, 0.02) << p.norm();
    EXPECT_LT((at.normal - p.normalized()).norm(), 0.03);
  }
}

TEST_F(FieldTest, APointSlidOverTheSurfaceSeesNoSteps) {
  const auto field = Build(fixtures::Sphere(5, 0.1));
  for (int line = 0; line < 20; ++line) {
    const Vector3d p0 = 0.1 * Direction(), along = Direction();
    Distance last = field->At(p0);
    const double h = 2e-5;
    for (int i = 1; i < 3000; ++i) {
      const Distance at = field->At(p0 + i * h * along);
      ASSERT_LT(std::abs(at.distance - last.distance), 1.03 * h + 1e-7);
      const double farther = std::max(0.02, std::abs((p0 + i * h * along).norm()));
      ASSERT_LT((at.normal - last.normal).norm(), 2 * h / farther + 1e-4);
      last = at;
    }
  }
}

TEST_F(FieldTest, NormalsLeadOutFromAnywhereInside) {
  for (const TriangleMesh& mesh : {fixtures::Sphere(3, 0.1), fixtures::Torus(0.15, 0.05, 60, 30),
                                   fixtures::Box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1})}) {
    const auto field = Build(mesh);
    for (int i = 0; i < 300; ++i) {
      Vector3d p = i == 0 ? Vector3d(0, 0, 0) : Point(0.2);
      int steps = 0;
      while (field->At(p).distance < 0 && ++steps < 100) {
        const Distance at = field->At(p);
        ASSERT_NEAR(at.normal.norm(), 1, 1e-5);
        p += (1e-3 - 0.5 * at.distance) * at.normal;
      }
      EXPECT_LT(steps, 100);
    }
  }
}

TEST_F(FieldTest, WhereAllCornersLookAwayOneOfThemDecides) {
  FieldGrid grid;  // The middle of a ball in the middle of its only cell.
  grid.side = 0.1;
  grid.cells = {1, 1, 1};
  grid.index.resize(1);
  grid.index[0].row = 2;
  for (int corner = 0; corner < 8; ++corner) {
    const float g = 1 / std::sqrt(3.0F);
    const auto sign = [&](int axis) { return corner >> axis & 1 ? g : -g; };
    grid.nodes.push_back({-0.05F, sign(0), sign(1), sign(2)});
  }
  const MeshField field(std::move(grid), {}, 0);
  const Distance at = field.At(Vector3d::Constant(0.05));
  EXPECT_NEAR(at.normal.norm(), 1, 1e-6);
  EXPECT_NEAR(std::abs(at.normal.x()), std::sqrt(1 / 3.), 1e-6);
}

TEST_F(FieldTest, OutsideTheGridDistancesGoOn) {
  const auto field = Build(fixtures::Sphere(4, 0.1));
  for (const double r : {0.2, 1.0, 30.0, 1000.0}) {
    for (int i = 0; i < 100; ++i) {
      const Vector3d p = r * Direction();
      const double beyond = field->At(p).distance - (r - 0.1);  // To some surface point.
      EXPECT_GT(beyond, -0.005 - 1e-6 * r);
      EXPECT_LT(beyond, 0.043 + 1e-6 * r);  // Towards the corner of a cube, for one of its faces.
      EXPECT_GT(field->At(p).normal.dot(p.normalized()), 0.98);
    }
  }
  const FieldGrid& grid = field->grid();  // Without a step at the border.
  for (int i = 0; i < 200; ++i) {
    Vector3d share(0.5 + 0.5 * sym_(rng_), 0.5 + 0.5 * sym_(rng_), 1);
    const Vector3d p = grid.origin + grid.side * share.cwiseProduct(Vector3d(
                                                     grid.cells[0], grid.cells[1], grid.cells[2]));
    const Vector3d h(0, 0, 1e-5);
    EXPECT_NEAR(field->At(p + h).distance, field->At(p - h).distance, 3e-5);
    EXPECT_LT((field->At(p + h).normal - field->At(p - h).normal).norm(), 1e-3);
  }
}

TEST_F(FieldTest, NumbersThatAreNotFiniteDoNoHarm) {
  const auto field = Build(fixtures::Sphere(2, 0.1));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e30, -1e30}) {
    static_cast<void>(field->At(Vector3d(bad, 0, 0)));
    static_cast<void>(field->At(Vector3d(bad, -bad, bad)));
  }
}

TEST_F(FieldTest, SignsAreThoseOfTheSolid) {
  const auto torus = Build(fixtures::Torus(0.2, 0.07, 120, 60));
  EXPECT_GT(torus->At({0, 0, 0}).distance, 0.12);
  EXPECT_LT(torus->At({0.2, 0, 0}).distance, -0.06);
  const auto nested = Build(fixtures::Together(fixtures::Sphere(3, 0.2), fixtures::Sphere(2, 0.1)));
  EXPECT_EQ(nested->report().buried_triangles, 320);
  EXPECT_NEAR(nested->At({0.1, 0, 0}).distance, -0.1, 0.01);
  const Vector3d aside(0.06, 0, 0);
  const auto overlapping =
      Build(fixtures::Together(fixtures::Sphere(4, 0.1, aside), fixtures::Sphere(4, 0.1, -aside)));
  for (int i = 0; i < 2000; ++i) {
    const Vector3d p = Point(0.2);
    const double d = std::min((p - aside).norm(), (p + aside).norm()) - 0.1;
    if (std::abs(d) > 1e-3) {
      EXPECT_EQ(overlapping->At(p).distance < 0, d < 0) << p.transpose();
    }
  }
}

TEST_F(FieldTest, AMeshWithASmallHoleIsAsGoodAsClosed) {
  const TriangleMesh ball = fixtures::Sphere(4, 0.1);
  const auto open =
      Build(fixtures::Part(ball, [](const Eigen::Vector3f& c) { return c.y() < 0.098F; }));
  EXPECT_EQ(open->report().holes, 1);
  for (int i = 0; i < 1000; ++i) {
    const Vector3d p = (0.1 + 0.01 * sym_(rng_)) * Direction();
    EXPECT_NEAR(open->At(p).distance, p.norm() - 0.1, 3.5e-3);  // The hole is flat: 2.5 mm.
  }
}

TEST_F(FieldTest, RefusesMoreBytesThanTheLimit) {
  FieldOptions options;
  options.max_bytes = 100'000;
  const auto field = MeshField::Build(fixtures::Sphere(3, 0.1), options, &pool_);
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, ErrorCode::kResourceExhausted);
  EXPECT_NE(field.error().message.find("100000"), std::string::npos) << field.error().message;
}

TEST_F(FieldTest, RefusesMoreWorkThanTheLimitWhereverItIs) {
  FieldOptions options;
  options.max_work = 300'000'000;
  // Of a heap already finding the surface may take more, of a smooth body only many cells do.
  const TriangleMesh meshes[] = {fixtures::Heap(3000, 0.05), fixtures::Heap(50, 0.05),
                                 fixtures::Sphere(5, 0.5)};
  for (const TriangleMesh& mesh : meshes) {
    const auto field = MeshField::Build(mesh, options, &pool_);
    ASSERT_FALSE(field) << mesh.triangles.size();
    EXPECT_EQ(field.error().code, ErrorCode::kResourceExhausted);
    EXPECT_EQ(field.error().field, "triangles");
    EXPECT_NE(field.error().message.find("does not pass through itself"), std::string::npos)
        << field.error().message;
  }
  options.max_work = FieldOptions().max_work / 20;  // What is usual is far from the limit.
  EXPECT_TRUE(MeshField::Build(fixtures::Sphere(4, 0.1), options, &pool_));
}

TEST_F(FieldTest, RefusesWhatIsFarTooMuchWorkAfterALookAtAFewCells) {
  FieldOptions options;
  options.max_work = 3'000'000'000;
  std::atomic<int> asked = 0;  // Once in a millisecond of work.
  const auto field = MeshField::Build(fixtures::Heap(100, 0.1), options, &pool_, [&] {
    ++asked;
    return false;
  });
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, ErrorCode::kResourceExhausted);
  EXPECT_NE(field.error().message.find("more than 3 s"), std::string::npos)
      << field.error().message;
  EXPECT_LT(asked, 1000);
}

TEST_F(FieldTest, StopsSoonWhenItIsNotWanted) {
  using Clock = std::chrono::steady_clock;
  std::atomic<int> asked = 0;
  const auto begin = Clock::now();
  const auto field =
      MeshField::Build(fixtures::Heap(1000, 0.05), {}, &pool_, [&] { return ++asked > 20; });
  ASSERT_FALSE(field);
  EXPECT_EQ(field.error().code, ErrorCode::kCancelled);
  EXPECT_LT(std::chrono::duration<double>(Clock::now() - begin).count(), 5);  // Of minutes.
}

TEST_F(FieldTest, IsTheSameForAnyNumberOfWorkers) {
  const TriangleMesh mesh = fixtures::Together(fixtures::Torus(0.1, 0.03, 60, 30),
                                               fixtures::Box({0, 0, 0}, {0.05, 0.06, 0.1}));
  exec::WorkerPool one(1), five(5);
  const auto a = MeshField::Build(mesh, {}, &one), b = MeshField::Build(mesh, {}, &five);
  ASSERT_TRUE(a && b);
  const FieldGrid &x = (*a)->grid(), &y = (*b)->grid();
  ASSERT_EQ(x.nodes.size(), y.nodes.size());
  ASSERT_EQ(x.index.size(), y.index.size());
  EXPECT_EQ(std::memcmp(x.nodes.data(), y.nodes.data(), x.nodes.size() * sizeof x.nodes[0]), 0);
  EXPECT_EQ(std::memcmp(x.index.data(), y.index.data(), x.index.size() * sizeof x.index[0]), 0);
  EXPECT_EQ((*a)->max_error(), (*b)->max_error());
  EXPECT_EQ((*a)->report().buried_triangles, (*b)->report().buried_triangles);
}

TEST_F(FieldTest, QueriesAllocateNothingAndFollowSingleOnes) {
  const auto field = Build(fixtures::Torus(0.1, 0.03, 60, 30));
  std::vector<float> x(2000), y(x), z(x), d(x), nx(x), ny(x), nz(x);
  for (size_t i = 0; i < x.size(); ++i) {
    x[i] = static_cast<float>(0.3 * sym_(rng_));
    y[i] = static_cast<float>(0.3 * sym_(rng_));
    z[i] = static_cast<float>(0.3 * sym_(rng_));
  }
  long allocations;
  {
    const mane::fixtures::AllocationCount count;
    field->At({x, y, z}, {d, nx, ny, nz});
    allocations = count.count();
  }
  EXPECT_EQ(allocations, 0);
  for (size_t i = 0; i < x.size(); ++i) {
    const Distance at = field->At({x[i], y[i], z[i]});
    EXPECT_EQ(d[i], static_cast<float>(at.distance));
    EXPECT_EQ(nx[i], static_cast<float>(at.normal.x()));
  }
}

}  // namespace
}  // namespace mane::contact
