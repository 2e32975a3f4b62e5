// Properties of the styling force field:
//   closed form  every kind of term against its formula, and terms add up
//   fade         full within the radius, nothing at twice that, no jump between
//   grid         linear fields are reproduced; zero outside; Sample is At
//   errors       the offending number is named

#include "styling/force_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "math/random.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

Vector3d RandomPoint(math::RandomStream* random, double size) {
  return {random->Uniform(-size, size), random->Uniform(-size, size), random->Uniform(-size, size)};
}

FieldTerm Term(FieldTerm::Kind kind) {
  FieldTerm term;
  term.kind = kind;
  term.strength = 1.5;
  term.direction = Vector3d(0, 2, 0);  // Its length does not matter.
  term.center = Vector3d(0.1, 0.2, -0.1);
  return term;
}

FieldTerm LinearGrid() {
  FieldTerm term = Term(FieldTerm::Kind::kGrid);
  auto grid = std::make_shared<FieldTerm::Grid>();
  grid->low = Vector3d(-0.1, 0, 0.1);
  grid->cell = 0.05;
  grid->nodes = {4, 3, 5};
  for (int z = 0; z < 5; ++z) {
    for (int y = 0; y < 3; ++y) {
      for (int x = 0; x < 4; ++x) {
        const Vector3d at = grid->low + grid->cell * Vector3d(x, y, z);
        grid->values.emplace_back(Vector3d(at.x() + 2 * at.y(), at.z(), 1 - at.x()).cast<float>());
      }
    }
  }
  term.grid = grid;
  return term;
}

TEST(ForceFieldTest, TermsAreWhatTheySay) {
  math::RandomStream random(1, 0);
  const FieldTerm uniform = Term(FieldTerm::Kind::kUniform);
  const FieldTerm pulled = Term(FieldTerm::Kind::kPulledBack);
  const FieldTerm vortex = Term(FieldTerm::Kind::kVortex);
  for (int i = 0; i < 100; ++i) {
    const Vector3d x = RandomPoint(&random, 1);
    const Vector3d v = x - pulled.center;
    EXPECT_LT((ForceField({uniform}).At(x) - Vector3d(0, 1.5, 0)).norm(), 1e-12);
    // Forces with a centre lose (1 mm / distance)^2 / 2 of their size (D2).
    const double core = 1.5 * 1e-6;
    const Vector3d pull = ForceField({pulled}).At(x);
    EXPECT_LT((pull + 1.5 * v.normalized()).norm(), core / v.squaredNorm());
    EXPECT_LT((pull + ForceField({Term(FieldTerm::Kind::kRadial)}).At(x)).norm(), 1e-12);
    const Vector3d around = Vector3d(v.z(), 0, -v.x());
    const Vector3d turning = ForceField({vortex}).At(x);
    EXPECT_LT((turning - 1.5 * around.normalized()).norm(), core / around.squaredNorm());
    const Vector3d sum = ForceField({uniform, pulled, vortex}).At(x);
    EXPECT_LT((sum - Vector3d(0, 1.5, 0) - pull - turning).norm(), 1e-12);
  }
  EXPECT_TRUE(ForceField({pulled}).At(pulled.center).isZero());
  EXPECT_TRUE(ForceField({}).At(Vector3d::Ones()).isZero());
}

TEST(ForceFieldTest, FadesBetweenOnceAndTwiceItsRadius) {
  for (const auto kind : {FieldTerm::Kind::kUniform, FieldTerm::Kind::kVortex}) {
    FieldTerm term = Term(kind);
    term.radius = 0.05;
    const ForceField field({term});
    term.radius = 0;
    const ForceField everywhere({term});
    double before = 1;
    for (double d = 0.03; d < 0.12; d += 1e-3) {
      const Vector3d x = term.center + Vector3d(d, 0, 0);
      const double share = field.At(x).norm() / everywhere.At(x).norm();
      EXPECT_LE(share, before + 1e-12);
      EXPECT_GT(share, before - 0.031);  // The steepest slope is 1.5 / radius.
      if (d <= 0.05) {
        EXPECT_NEAR(share, 1, 1e-12);
      }
      if (d >= 0.1) {
        EXPECT_NEAR(share, 0, 1e-12);
      }
      before = share;
    }
    // A vortex fades with the distance from its axis only.
    const Vector3d along = term.center + Vector3d(0.02, 5, 0);
    EXPECT_EQ(field.At(along).norm() > 0, kind == FieldTerm::Kind::kVortex);
  }
}

TEST(ForceFieldTest, GridsReproduceLinearFields) {
  const FieldTerm term = LinearGrid();
  ASSERT_TRUE(Validate({term}, "field"));
  const ForceField field({term});
  math::RandomStream random(2, 0);
  for (int i = 0; i < 200; ++i) {
    const Vector3d x = term.grid->low + Vector3d(random.Uniform(0, 0.15), random.Uniform(0, 0.1),
                                                 random.Uniform(0, 0.2));
    const Vector3d expected = 1.5 * Vector3d(x.x() + 2 * x.y(), x.z(), 1 - x.x());
    EXPECT_LT((field.At(x) - expected).norm(), 1e-6);  // Float32 at the nodes.
  }
  EXPECT_TRUE(field.At(term.grid->low - Vector3d(1e-9, 0, 0)).isZero());
  EXPECT_TRUE(field.At({0, 0.1001, 0.2}).isZero());
  EXPECT_FALSE(field.At({0.05, 0.1, 0.3}).isZero());  // The last node belongs to it.
}

TEST(ForceFieldTest, SamplesAreItsValuesXFastest) {
  const ForceField field({Term(FieldTerm::Kind::kRadial)});
  const auto values = field.Sample({1, 2, 3}, 0.5, {3, 2, 4});
  ASSERT_EQ(values.size(), 24u);
  EXPECT_EQ(values[2 + 3 * (1 + 2 * 3)], field.At({2, 2.5, 4.5}).cast<float>());
}

TEST(ForceFieldTest, ErrorsNameTheNumber) {
  const auto field_of = [](const FieldTerm& term) {
    const auto valid = Validate({FieldTerm{}, FieldTerm{}, term}, "field");
    return valid ? "" : valid.error().field;
  };
  EXPECT_EQ(field_of({}), "");
  FieldTerm term = LinearGrid();
  auto grid = std::make_shared<FieldTerm::Grid>(*term.grid);
  grid->values.pop_back();
  term.grid = grid;
  EXPECT_EQ(field_of(term), "field[2].grid.values");
  grid->values.emplace_back(0, std::numeric_limits<float>::quiet_NaN(), 0);
  EXPECT_EQ(field_of(term), "field[2].grid.values[59].y");
  grid->nodes = {1, 3, 5};
  EXPECT_EQ(field_of(term), "field[2].grid.nodes.x");
  term.grid = nullptr;
  EXPECT_EQ(field_of(term), "field[2].grid");
  term = {};
  term.direction.setZero();
  EXPECT_EQ(field_of(term), "field[2].direction");
  term = {};
  term.strength = std::numeric_limits<double>::infinity();
  EXPECT_EQ(field_of(term), "field[2].strength");
  term = {};
  term.radius = -1;
  EXPECT_EQ(field_of(term), "field[2].radius_m");
  EXPECT_EQ(Validate(std::vector<FieldTerm>(65), "field").error().field, "field");
}

}  // namespace
}  // namespace mane::styling
