// Laws of the deformation solver:
//   lengths     all segments are equally long
//   details     are those that were given; control points are joints plus details in their frames
//   head        no joint and no control point goes into an ellipsoid or a mesh
//   density     the field holds the volume of all strands; lower thresholds spread hair wider
//   bending     stiffer hair droops less
//   workers     1 and 4 make the same bits
//   cost        looks grow as segments do; a call that nobody waits for stops

#include "styling/solver.h"

#include <gtest/gtest.h>

#include <cmath>

#include "contact/mesh.h"
#include "math/random.h"
#include "styling/solver_fixture.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using fixtures::Hair;
using fixtures::Solve;

void AddDetails(Hair* hair, double size) {
  math::RandomStream random(7, 0);
  for (Vector3f& details : hair->masters.details) {
    details = Vector3d(0, random.Uniform(-size, size), random.Uniform(-size, size)).cast<float>();
  }
}

template <typename Visit>
void ForJoints(const Masters& masters, const Visit& visit) {
  for (size_t w = 0; w + 1 < masters.first_joint.size(); ++w) {
    for (size_t j = masters.first_joint[w]; j < masters.first_joint[w + 1]; ++j) {
      visit(j, j == masters.first_joint[w]);
    }
  }
}

void ExpectOutside(const Hair& hair, double clearance) {
  ForJoints(hair.masters, [&](size_t j, bool root) {
    const double joint =
        DistanceTo(hair.input.obstacles, hair.masters.outline[j].cast<double>()).distance;
    const double point =
        DistanceTo(hair.input.obstacles, hair.masters.points[j].cast<double>()).distance;
    const double least = root ? -1e-6 : clearance - 1e-6;
    EXPECT_GE(joint, least) << j;
    EXPECT_GE(point, least) << j;
  });
}

TEST(SolverTest, SegmentsKeepTheirLengthAndDetailsAreWhatTheyWere) {
  Hair hair = fixtures::HairOn(fixtures::Head(), 200, 25, 0.01, 100);
  AddDetails(&hair, 0.01);
  const auto details = hair.masters.details;
  Solve(&hair);
  const Masters& masters = hair.masters;
  EXPECT_EQ(masters.details, details);
  int shortened = 0;
  ForJoints(masters, [&](size_t j, bool root) {
    const Vector3f& c = masters.outline[j];
    if (!root) {
      const Vector3f segment = c - masters.outline[j - 1];
      EXPECT_NEAR(segment.norm(), 0.01, 1e-6);
      // The x axis of the joint before lies along it.
      EXPECT_LT((masters.frames[j - 1] * Vector3f::UnitX() - segment / 0.01f).norm(), 1e-4);
    }
    const Vector3f full = masters.frames[j] * details[j];
    const Vector3f kept = masters.points[j] - c;
    const bool whole = (kept - full).norm() < 1e-6f;
    if (!whole) {  // Shortened, toward the joint, and only where it would go in.
      EXPECT_LT(kept.cross(full).norm(), 1e-8);
      EXPECT_LT(DistanceTo(hair.input.obstacles, (c + full).cast<double>()).distance, 1.001e-3);
    }
    shortened += !whole;
  });
  EXPECT_GT(shortened, 20);
  EXPECT_LT(shortened, masters.joints() / 2);
}

TEST(SolverTest, NothingGoesIntoAnEllipsoid) {
  for (const double kappa : {0.0, 0.5}) {
    Hair hair = fixtures::HairOn(fixtures::Head(), 300, 30, 0.01, 200);
    hair.input.bending_stiffness = kappa;
    AddDetails(&hair, 0.01);
    Solve(&hair);
    ExpectOutside(hair, 1e-3);
  }
}

TEST(SolverTest, NothingGoesIntoAMesh) {
  // Two boxes as a head on shoulders, with concave edges where hair comes to lie.
  contact::TriangleMesh mesh;
  const auto add_box = [&](const Vector3f& low, const Vector3f& high) {
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 8; ++k) {
      mesh.vertices.emplace_back(k & 1 ? high.x() : low.x(), k & 2 ? high.y() : low.y(),
                                 k & 4 ? high.z() : low.z());
    }
    const uint32_t faces[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    for (const auto& f : faces) {
      mesh.triangles.push_back({first + f[0], first + f[1], first + f[2]});
      mesh.triangles.push_back({first + f[0], first + f[2], first + f[3]});
    }
  };
  add_box({-0.07f, -0.08f, -0.08f}, {0.07f, 0.1f, 0.08f});
  add_box({-0.2f, -0.2f, -0.1f}, {0.2f, -0.12f, 0.1f});
  exec::WorkerPool pool(1);
  auto field = contact::MeshField::Build(mesh, {}, &pool);
  ASSERT_TRUE(field);
  Hair hair = fixtures::HairOn({{*field, {}}}, 1, 30, 0.01, 100);
  for (int i = 0; i < 100; ++i) {
    const double z = -0.08 + 0.0016 * i;
    fixtures::AddWisp(&hair, {0.0701, 0.09 - 0.001 * i, z}, Vector3d::UnitX(), 35, 100);
    fixtures::AddWisp(&hair, {z * 0.8, 0.1001, z}, Vector3d::UnitY(), 35, 100);
  }
  hair.input.roots[0].position = {0.01, 0.1002, 0.02};
  AddDetails(&hair, 0.008);
  Solve(&hair);
  ExpectOutside(hair, 1e-3);
}

TEST(SolverTest, TheDensityIsTheVolumeOfAllStrands) {
  Hair hair = fixtures::HairOn({}, 100, 20, 0.01, 30);
  hair.input.obstacles = fixtures::Head();
  const Deformed solved = Solve(&hair);
  exec::WorkerPool pool(1);
  auto solid = DensityField::Make(solved.density->box(), hair.input.obstacles, &pool);
  const auto all = solved.density->Values(), head = solid->Values();
  double sum = 0;
  for (size_t i = 0; i < all.size(); ++i) sum += all[i] - head[i];
  const double cell = solved.density->box().cell;
  EXPECT_NEAR(sum * std::pow(cell, 3) / (100 * 20 * 30 * 7e-8 * 0.01), 1, 1e-4);
}

TEST(SolverTest, LowerThresholdsSpreadHairWider) {
  double before = 0;
  for (const double tau : {0.9, 0.4, 0.2, 0.1, 0.05}) {
    Hair hair = fixtures::HairOn(fixtures::Head(), 500, 12, 0.01, 100);
    hair.input.density_threshold = tau;
    Solve(&hair);
    double sum = 0;
    for (const Vector3f& c : hair.masters.outline) {
      sum += std::pow(DistanceTo(hair.input.obstacles, c.cast<double>()).distance, 2);
    }
    const double rms = std::sqrt(sum / hair.masters.joints());
    EXPECT_GT(rms, before * 1.005) << tau;
    before = rms;
  }
}

TEST(SolverTest, StifferHairDroopsLess) {
  double before = -1e9;
  for (const double kappa : {0.0, 0.2, 0.5, 1.0, 2.5, 10.0, 1000.0}) {
    Hair hair = fixtures::WispAt({0, 0, 0}, Vector3d::UnitX(), 20, 0.01);
    hair.input.bending_stiffness = kappa;
    Solve(&hair);
    const double tip = hair.masters.outline.back().y();
    EXPECT_GT(tip, before) << kappa;
    before = tip;
  }
  // Joint k turns by 1 / kappa: the tip sinks by l (1 + 2 + ... + 20) / kappa.
  EXPECT_NEAR(before, -0.01 * 210 / 1000, 1e-5);
}

TEST(SolverTest, OneJointIsTheClosedForm) {
  Hair hair = fixtures::WispAt({0, 0, 0}, Vector3d::UnitX(), 2, 0.01);
  hair.input.bending_stiffness = 0.8;
  Solve(&hair);
  const Vector3d first = Vector3d(0.8, -1, 0).normalized();
  const Vector3d second = (0.8 * first - Vector3d::UnitY()).normalized();
  EXPECT_LT((hair.masters.outline[1].cast<double>() - 0.01 * first).norm(), 1e-8);
  EXPECT_LT((hair.masters.outline[2].cast<double>() - 0.01 * (first + second)).norm(), 1e-8);
}

TEST(SolverTest, AWispThatIsTooDenseAloneGoesWhereItWould) {
  Hair thin = fixtures::WispAt({0, 0, 0}, Vector3d::UnitX(), 20, 0.01);
  Hair thick = thin;
  for (float& strands : thick.input.strands) strands = 1e5f;
  Solve(&thin);
  const Deformed solved = Solve(&thick);
  EXPECT_EQ(solved.report.dense_segments, 0);
  EXPECT_EQ(thin.masters.outline, thick.masters.outline);
}

TEST(SolverTest, AnyNumberOfWorkersMakesTheSameBits) {
  Hair one = fixtures::HairOn(fixtures::Head(), 500, 15, 0.01, 200);
  one.input.density_threshold = 0.2;
  AddDetails(&one, 0.005);
  Hair four = one;
  const Deformed a = Solve(&one, 1), b = Solve(&four, 4);
  EXPECT_EQ(one.masters.outline, four.masters.outline);
  EXPECT_EQ(one.masters.points, four.masters.points);
  EXPECT_EQ(a.density->Values(), b.density->Values());
  EXPECT_EQ(a.report.tries, b.report.tries);
}

TEST(SolverTest, WorkGrowsAsSegmentsDo) {
  const auto work = [](int wisps, int segments) {
    Hair hair = fixtures::HairOn(fixtures::Head(), wisps, segments, 0.01, 10);
    const SolverReport report = Solve(&hair).report;
    EXPECT_EQ(report.segments, wisps * segments);
    return static_cast<double>(report.nodes + 100 * report.tries);
  };
  const double base = work(200, 10);
  EXPECT_NEAR(work(400, 10) / base, 2, 0.1);
  EXPECT_NEAR(work(200, 40) / base, 4, 0.4);
}

TEST(SolverTest, StopsWhenNobodyWaits) {
  Hair hair = fixtures::HairOn(fixtures::Head(), 300, 20, 0.01, 10);
  exec::WorkerPool pool(1);
  int asked = 0;
  double last = 0;
  const auto stopped = Deform(
      hair.input, &hair.masters, [&] { return last > 0.4 && ++asked > 0; },
      [&](double share) {
        EXPECT_GT(share, last);
        last = share;
      },
      &pool);
  ASSERT_FALSE(stopped);
  EXPECT_EQ(stopped.error().code, ErrorCode::kCancelled);
  EXPECT_EQ(asked, 1);
  EXPECT_LT(last, 0.46);
}

}  // namespace
}  // namespace mane::styling
