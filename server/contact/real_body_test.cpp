// The MakeHuman body: accepted as it is, within 0.5 mm of the exact distance in the band of 10 mm
// around its head, signs right all over, and of a size and a speed as stated in contact.md. Skipped
// where the shared data is not there.

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "contact/mesh_field.h"
#include "contact/repair.h"
#include "contact/solid_distance.h"
#include "contact/test_meshes.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

bool IsHead(const Vector3f& p) { return p.y() > 0.6F; }

class RealBodyTest : public ::testing::Test {
 protected:
  void SetUp() override {
    const auto body = fixtures::RealBody();
    if (!body) GTEST_SKIP() << "no ../shared/data/heads/makehuman_base.obj; MANE_SHARED is unset";
    body_ = *body;
  }
  // Points within 10 mm along each axis of the surface where `keep` says so.
  std::vector<Vector3d> Near(const SolidMesh& surface, int count, bool (*keep)(const Vector3f&)) {
    std::vector<Vector3d> points;
    while (std::ssize(points) < count) {
      const Triangle& t = surface.triangles[rng_() % surface.triangles.size()];
      const double u = 0.5 + 0.5 * sym_(rng_), v = (1 - u) * (0.5 + 0.5 * sym_(rng_));
      const Vector3d p = surface.vertices[t[0]] * (1 - u - v) + surface.vertices[t[1]] * u +
                         surface.vertices[t[2]] * v;
      if (!keep(p.cast<float>())) continue;
      points.push_back(p + 0.01 * Vector3d(sym_(rng_), sym_(rng_), sym_(rng_)));
    }
    return points;
  }
  // Largest error in the band, and of signs that matter none is wrong.
  void ExpectAccurate(const TriangleMesh& mesh, const MeshField& field,
                      bool (*keep)(const Vector3f&)) {
    MeshReport report;
    const SolidDistance exact(*Repair(mesh, {}, &report), &pool_);
    double worst = 0;
    for (const Vector3d& p : Near(exact.surface(), 20'000, keep)) {
      const double d = exact.At(p, 0.02).distance;
      if (std::abs(d) <= 0.01) worst = std::max(worst, std::abs(field.At(p).distance - d));
    }
    RecordProperty("worst_um", static_cast<int>(1e6 * worst));
    EXPECT_LT(worst, 5e-4);
    EXPECT_LT(field.max_error(), 5e-4);
  }

  exec::WorkerPool pool_{2};
  TriangleMesh body_;
  std::mt19937_64 rng_{20240124};
  std::uniform_real_distribution<double> sym_{-1, 1};
};

TEST_F(RealBodyTest, TheWholeBody) {
  const auto field = MeshField::Build(body_, {}, &pool_);
  ASSERT_TRUE(field) << field.error().message;
  const MeshReport& report = (*field)->report();
  EXPECT_EQ(report.triangles, 26756);
  EXPECT_EQ(report.holes, 0);
  EXPECT_FALSE(report.inverted);
  EXPECT_NEAR(report.volume, 0.0549, 1e-4);
  EXPECT_LT((*field)->bytes(), 80e6);
  ExpectAccurate(body_, **field, [](const Vector3f&) { return true; });
}

TEST_F(RealBodyTest, ItsHeadCutAtTheNeck) {
  const TriangleMesh head = fixtures::Part(body_, IsHead);
  const auto field = MeshField::Build(head, {}, &pool_);
  ASSERT_TRUE(field) << field.error().message;
  EXPECT_EQ((*field)->report().holes, 1);
  EXPECT_LT((*field)->bytes(), 60e6);
  ExpectAccurate(head, **field, IsHead);
}

}  // namespace
}  // namespace mane::contact
