// Properties of graded element lengths:
//   sum       they are N positive lengths that sum to L, never shorter than the one before
//   layer     half of them lie in the layer of a heavy strand and half are even; light ones even
//   curl      curled and wound hair grow as stated
//   motion    a shaken strand is nearer to the converged one than with equal lengths, for all hair
//             types, lengths and roots (rest and frequencies: statics_test, modes_test)

#include "rod/graded_lengths.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "rod/test_shake.h"

namespace mane::rod {
namespace {

using Eigen::Vector3d;

Grading GradingOf(const Strand& strand) {
  return {.length = strand.TotalLength(),
          .stiffness = strand.stiffness.tail<2>().minCoeff(),
          .linear_density = strand.linear_density,
          .curl = strand.natural[0].norm()};
}

Strand Graded(const Strand& one, int N) {
  Strand strand = one;
  strand.length = GradedLengths(GradingOf(one), N);
  strand.natural.assign(N, one.natural[0]);
  return strand;
}

TEST(GradedLengthsTest, ArePositiveAndGrowAndSumToTheLength) {
  for (const double number : {1e-6, 0.1, 7.0, 163.0, 1e4, 1e8}) {
    for (const bool curled : {false, true}) {
      for (const bool wound : {false, true}) {
        Grading grading = GradingOf(fixtures::HeavyStrand(number, 1));
        EXPECT_NEAR(GravitoBendingNumber(grading) / number, 1, 1e-12);
        if (curled) grading.curl = 50;
        grading.wound = wound;
        for (const int N : {1, 2, 5, 10, 64, 256}) {
          const std::vector<double> lengths = GradedLengths(grading, N);
          ASSERT_EQ(std::ssize(lengths), N);
          EXPECT_GT(lengths[0], 0);
          for (int Q = 1; Q < N; ++Q) EXPECT_GE(lengths[Q], lengths[Q - 1] * (1 - 1e-9));
          EXPECT_NEAR(std::accumulate(lengths.begin(), lengths.end(), 0.0), 0.2, 1e-15);
        }
      }
    }
  }
}

TEST(GradedLengthsTest, GiveHalfOfTheElementsToTheLayerOfHeavyHair) {
  // Number 1e6: a layer of L / 1000, of which a share 1 - exp(-k) lies within k layers.
  const std::vector<double> lengths = GradedLengths(GradingOf(fixtures::HeavyStrand(1e6, 1)), 200);
  double position = 0;
  int near = 0, within_layer = 0;
  for (const double l : lengths) {
    position += l;
    within_layer += position < 0.2 * 1e-3 ? 1 : 0;
    near += position < 0.2 * 1e-2 ? 1 : 0;
  }
  EXPECT_NEAR(within_layer, 100 * (1 - std::exp(-1)), 2);
  EXPECT_NEAR(near, 101, 2);
  EXPECT_NEAR(lengths.back(), 0.2 / 100, 1e-6);
}

TEST(GradedLengthsTest, AreNearlyEvenForLightHair) {
  const std::vector<double> lengths = GradedLengths(GradingOf(fixtures::HeavyStrand(0.01, 1)), 10);
  EXPECT_LT(lengths.back() / lengths.front(), 2.5);
}

TEST(GradedLengthsTest, GrowAlongCurledAndWoundHairAsStated) {
  Grading grading = GradingOf(fixtures::MakeStrand(fixtures::AppendixB()[2], 0.2, 1));
  for (const int N : {4, 10, 20}) {
    const std::vector<double> lengths = GradedLengths(grading, N);
    for (int Q = 1; Q < N; ++Q) {
      EXPECT_NEAR(lengths[Q] / lengths[Q - 1], std::pow(4, 1.0 / N), 1e-12);
    }
  }
  grading.wound = true;  // coil.md, Which strands.
  const std::pair<int, double> table[] = {{5, 1.4}, {8, 1.2}, {10, 1.15}};
  for (const auto& [N, growth] : table) {
    const std::vector<double> lengths = GradedLengths(grading, N);
    for (int Q = 1; Q < N; ++Q) EXPECT_NEAR(lengths[Q] / lengths[Q - 1], growth, 0.01);
  }
}

TEST(GradedLengthsTest, MoveHairNearerToTheConvergedStrandThanEqualLengths) {
  struct Case {
    int hair;
    double length;
    int N;
    double at_most;  // Error over that of equal lengths.
  };
  for (const Case& c :
       {Case{0, 0.1, 5, 0.5}, Case{0, 0.1, 10, 0.5}, Case{0, 0.2, 5, 0.2}, Case{0, 0.2, 10, 0.2},
        Case{0, 0.3, 5, 0.2}, Case{0, 0.3, 10, 0.2}, Case{0, 0.5, 5, 0.2}, Case{0, 0.5, 10, 0.2},
        Case{1, 0.1, 10, 0.9}, Case{1, 0.2, 10, 0.7}, Case{1, 0.3, 10, 0.7}, Case{2, 0.1, 10, 0.8},
        Case{2, 0.2, 20, 0.7}}) {
    const Strand equal = fixtures::MakeStrand(fixtures::AppendixB()[c.hair], c.length, c.N);
    const Strand graded = Graded(equal, c.N), converged = Graded(equal, 80);
    double graded_squares = 0, equal_squares = 0;
    for (const math::Pose& root : fixtures::SideRoots()) {
      const std::vector<Vector3d> tips = fixtures::ShakenTips(converged, root);
      ASSERT_FALSE(tips.empty());
      graded_squares +=
          std::pow(fixtures::RmsDistance(tips, fixtures::ShakenTips(graded, root)), 2);
      equal_squares += std::pow(fixtures::RmsDistance(tips, fixtures::ShakenTips(equal, root)), 2);
    }
    EXPECT_LT(std::sqrt(graded_squares / equal_squares), c.at_most)
        << fixtures::AppendixB()[c.hair].name << " " << c.length << " " << c.N << ": "
        << std::sqrt(graded_squares / 6) / c.length;
  }
}

}  // namespace
}  // namespace mane::rod
