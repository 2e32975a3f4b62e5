// Nearest places on paths against brute force; Psi of each kind; errors name the field.

#include "styling/constraint.h"

#include <gtest/gtest.h>

#include <cmath>

#include "math/random.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Kind = Constraint::Kind;

TEST(PathTest, NearestIsWhatBruteForceFinds) {
  math::RandomStream random(1, 0);
  const auto point = [&] {
    return Vector3d(random.Uniform(-1, 1), random.Uniform(-1, 1), random.Uniform(-1, 1));
  };
  for (int k = 0; k < 20; ++k) {
    std::vector<Vector3d> points;
    for (int i = 0; i < 6; ++i) points.push_back(point());
    const Path path(points);
    const Vector3d x = point();
    const double begin = random.Uniform(0, path.length() / 2);
    const double end = random.Uniform(begin, path.length());
    double best = HUGE_VAL, arc = 0;
    for (size_t i = 0; i + 1 < points.size(); ++i) {
      const Vector3d piece = points[i + 1] - points[i];
      for (int s = 0; s <= 2000; ++s) {
        const double at = arc + piece.norm() * s / 2000;
        if (at < begin || at > end) continue;
        best = std::min(best, (points[i] + piece * s / 2000 - x).norm());
      }
      arc += piece.norm();
    }
    EXPECT_NEAR(path.length(), arc, 1e-12);
    const PathPlace place = path.Nearest(x, begin, end);
    // Samples lie 1 mm apart.
    EXPECT_LE(place.distance, best + 1e-12);
    EXPECT_GT(place.distance, best - 1.8e-3);
    EXPECT_NEAR((x - place.point).norm(), place.distance, 1e-12);
    EXPECT_NEAR(place.tangent.norm(), 1, 1e-12);
    EXPECT_GE(place.arc, begin - 1e-12);
    EXPECT_LE(place.arc, end + 1e-12);
    EXPECT_EQ(path.TangentAt(place.arc - 1e-9 * (place.arc > begin)).norm() > 0.5, true);
  }
}

TEST(PsiTest, IsAUnitVectorOfItsKind) {
  const std::vector<Vector3d> line{{0, 0, 0}, {1, 0, 0}};
  const Path path(line);
  const auto psi = [&](Kind kind, const Vector3d& x) {
    const Constraint constraint{kind, line, 0.1, 1};
    return Psi(constraint, path, path.Nearest(x), x, 0.01);
  };
  const Vector3d outside(0.5, 0.3, 0), inside(0.5, 0.05, 0);
  EXPECT_EQ(psi(Kind::kTrajectory, outside), -Vector3d::UnitY());
  EXPECT_LT((psi(Kind::kTrajectory, inside) - Vector3d(1, -0.5, 0).normalized()).norm(), 1e-12);
  EXPECT_LT((psi(Kind::kTrajectory, {0.5, 0, 0}) - Vector3d::UnitX()).norm(), 1e-12);
  EXPECT_TRUE(psi(Kind::kDirection, outside).isZero());
  EXPECT_EQ(psi(Kind::kDirection, inside), Vector3d::UnitX());
  const std::vector<Vector3d> one{{1, 2, 3}};
  const Path point(one);
  EXPECT_LT((Psi({Kind::kPoint, one, 0.1, 1}, point, point.Nearest({1, 2, 0}), {1, 2, 0}, 0.01) -
             Vector3d::UnitZ())
                .norm(),
            1e-12);
}

TEST(ConstraintTest, ErrorsNameTheField) {
  const Obstacles ball{{contact::Ellipsoid(Vector3d(0.1, 0.1, 0.1)), {}}};
  const auto field_of = [&](const Constraint& constraint) {
    std::vector<ConstraintQueue> queues(2);
    queues[0].constraints = {{Kind::kPoint, {Vector3d(0, 1, 0)}, 0.01, 1}};
    queues[1].constraints = {constraint};
    const auto valid = Validate(queues, ball, "queues");
    return valid ? "" : valid.error().field;
  };
  const Vector3d a(0, 0.2, 0), b(0, 0.3, 0);
  const std::string prefix = "queues[1].constraints[0].";
  EXPECT_EQ(field_of({Kind::kPoint, {a}, 0.01, 1}), "");
  EXPECT_EQ(field_of({Kind::kPoint, {Vector3d(0, 0.095, 0)}, 0.01, 1}), "");
  EXPECT_EQ(field_of({Kind::kPoint, {Vector3d(0, 0.085, 0)}, 0.01, 1}), prefix + "path[0]");
  EXPECT_EQ(field_of({Kind::kTrajectory, {a, Vector3d(0, 0.01, 0)}, 0.01, 1}), prefix + "path[1]");
  EXPECT_EQ(field_of({Kind::kDirection, {a, Vector3d(0, 0.01, 0)}, 0.01, 1}), "");
  EXPECT_EQ(field_of({Kind::kPoint, {a, b}, 0.01, 1}), prefix + "path");
  EXPECT_EQ(field_of({Kind::kTrajectory, {a}, 0.01, 1}), prefix + "path");
  EXPECT_EQ(field_of({Kind::kTrajectory, {a, b, b}, 0.01, 1}), prefix + "path[2]");
  EXPECT_EQ(field_of({Kind::kPoint, {Vector3d(0, NAN, 0)}, 0.01, 1}), prefix + "path[0].y");
  EXPECT_EQ(field_of({Kind::kPoint, {a}, 0, 1}), prefix + "radius_m");
  EXPECT_EQ(field_of({Kind::kPoint, {a}, 0.01, 1.5}), prefix + "weight");
  EXPECT_EQ(field_of({Kind::kPoint, {a}, 0.01, NAN}), prefix + "weight");
  EXPECT_EQ(Validate(std::vector<ConstraintQueue>(1), ball, "queues").error().field,
            "queues[0].constraints");
}

TEST(ConstraintTest, AWispInTwoQueuesNamesBoth) {
  std::vector<ConstraintQueue> queues(3);
  queues[0].name = "left";
  queues[2].name = "tail";
  EXPECT_TRUE(ValidateSelections(queues, {{0, 1}, {2}, {3}}, 5, "queues"));
  const auto twice = ValidateSelections(queues, {{0, 1}, {2}, {3, 1}}, 5, "queues");
  ASSERT_FALSE(twice);
  EXPECT_EQ(twice.error().field, "queues[2].selection");
  EXPECT_NE(twice.error().message.find("left"), std::string::npos);
  EXPECT_NE(twice.error().message.find("tail"), std::string::npos);
}

}  // namespace
}  // namespace mane::styling
