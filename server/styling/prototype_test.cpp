// Laws of prototypes: shipped ones have their size and scale with it, at any spacing; a drawn one
// gives the details that it was drawn with; faults are named.

#include "styling/prototype.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

namespace mane::styling {
namespace {

using Eigen::Vector3d;
constexpr StrandKind kShaped[] = {StrandKind::kWavy, StrandKind::kCurly, StrandKind::kFuzzy,
                                  StrandKind::kKinky};

double Rms(const Pattern& pattern) {
  double sum = 0;
  for (const auto& delta : pattern.details) sum += delta.squaredNorm();
  return std::sqrt(sum / static_cast<double>(pattern.details.size()));
}

Pattern DetailsOf(const Prototype& prototype, double segment_length) {
  auto pattern = PrototypeDetails(prototype, segment_length, "p");
  EXPECT_TRUE(pattern.has_value()) << pattern.error().message;
  return *pattern;
}

std::string FaultOf(const Prototype& prototype, double segment_length) {
  const auto pattern = PrototypeDetails(prototype, segment_length, "p");
  return pattern ? "" : pattern.error().field;
}

TEST(PrototypeTest, StraightHairHasNoDetails) {
  const Pattern pattern = DetailsOf({}, 0.01);
  EXPECT_EQ(Rms(pattern), 0);
  EXPECT_EQ(pattern.structure, 0);
}

TEST(PrototypeTest, ShippedOnesHaveTheirSize) {
  for (StrandKind kind : kShaped) {
    SCOPED_TRACE(static_cast<int>(kind));
    const StrandSize size = SizeOf(kind);
    for (int points : {5, 10, 24}) {
      const Pattern pattern = DetailsOf({kind, 0, 0, {}}, size.period / points);
      EXPECT_NEAR(pattern.structure, points, 1);
      EXPECT_NEAR(static_cast<int>(pattern.details.size()), 12 * points + 1, 1);
      // Of a wave rms is 0.7 amplitudes, of a helix 1; a window that no irregular turn fits takes
      // some of it.
      EXPECT_GT(Rms(pattern), 0.45 * size.amplitude);
      EXPECT_LT(Rms(pattern), 1.1 * size.amplitude);
      for (const auto& delta : pattern.details) EXPECT_LT(delta.norm(), 2 * size.amplitude);
    }
  }
}

TEST(PrototypeTest, ShippedOnesScaleWithTheirSize) {
  for (StrandKind kind : kShaped) {
    const Pattern one = DetailsOf({kind, 0.002, 0.02, {}}, 0.002);
    const Pattern two = DetailsOf({kind, 0.004, 0.04, {}}, 0.004);
    ASSERT_EQ(one.details.size(), two.details.size());
    for (size_t i = 0; i < one.details.size(); ++i) {
      EXPECT_LT((two.details[i] - 2 * one.details[i]).norm(), 1e-7);
    }
  }
}

TEST(PrototypeTest, NoTwoTurnsAreAlike) {
  for (StrandKind kind : kShaped) {
    const StrandSize size = SizeOf(kind);
    const Pattern pattern = DetailsOf({kind, 0, 0, {}}, size.period / 8);
    double difference = 0;
    for (size_t i = 16; i + 16 < pattern.details.size(); ++i) {
      difference += (pattern.details[i + 8] - pattern.details[i]).squaredNorm();
    }
    EXPECT_GT(std::sqrt(difference / static_cast<double>(pattern.details.size())),
              0.1 * size.amplitude);
  }
}

TEST(PrototypeTest, ADrawnWaveGivesItsDetails) {
  Prototype prototype;
  for (int i = 0; i <= 500; ++i) {
    const double x = 0.2 * i / 500;
    prototype.points.push_back(Vector3d(5, 6, 7) +
                               Vector3d(x, 0.003 * std::sin(x * 2 * std::numbers::pi / 0.04), 0));
  }
  const Pattern pattern = DetailsOf(prototype, 0.004);
  EXPECT_EQ(pattern.structure, 10);
  EXPECT_NEAR(Rms(pattern), 0.003 / std::numbers::sqrt2, 1e-4);
  ASSERT_GE(pattern.details.size(), 50U);
  for (int i = 0; i < 50; ++i) {  // 0.1 of the amplitude over 5 turns, twice: outline_test.cpp.
    EXPECT_NEAR(std::abs(pattern.details[i].norm()),
                std::abs(0.003 * std::sin(0.2 * std::numbers::pi * i)), 1.5e-4);
  }
}

TEST(PrototypeTest, FaultsAreNamed) {
  Prototype drawn;
  drawn.points = {{0, 0, 0}, {0.01, 0, 0}, {0.02, 0, 0}, {0.03, 0.001, 0}};
  EXPECT_EQ(FaultOf(drawn, 0.01), "");
  EXPECT_EQ(FaultOf(drawn, 0.05), "p.points");     // Shorter than a segment.
  EXPECT_EQ(FaultOf(drawn, 0.00001), "p.points");  // More than kMostDetails.
  EXPECT_EQ(FaultOf(drawn, 1e-9), "p.points");
  drawn.points[3].x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(FaultOf(drawn, 0.01), "p.points[3].x");
  drawn.points.resize(3);
  EXPECT_EQ(FaultOf(drawn, 0.01), "p.points");
  drawn.points.assign(4, Vector3d::Ones());  // All in one place.
  EXPECT_EQ(FaultOf(drawn, 0.01), "p.points");
  drawn.points.assign(5000, Vector3d::Ones());
  EXPECT_EQ(FaultOf(drawn, 0.01), "p.points");

  EXPECT_EQ(FaultOf({StrandKind::kCurly, -0.001, 0, {}}, 0.004), "p.amplitude_m");
  EXPECT_EQ(FaultOf({StrandKind::kCurly, 0, 2, {}}, 0.004), "p.period_m");
  EXPECT_EQ(FaultOf({StrandKind::kCurly, 0, 0.02, {}}, 0.00501), "p.period_m");
  EXPECT_EQ(FaultOf({StrandKind::kCurly, 0, 0.02, {}}, 0.005), "");
  EXPECT_EQ(FaultOf({StrandKind::kCurly, 0, 0.02, {}}, 0.02 / 256), "p.period_m");
  EXPECT_EQ(FaultOf({StrandKind::kCurly, 0, 0.02, {}}, 0.02 / 255), "");
}

TEST(PrototypeTest, ACoarseSpacingSaysWhatToDo) {
  const auto pattern = PrototypeDetails({StrandKind::kKinky, 0, 0, {}}, 0.01, "style.prototype");
  ASSERT_FALSE(pattern.has_value());
  EXPECT_NE(pattern.error().message.find("segment_length_m of at most 0.0015 m"), std::string::npos)
      << pattern.error().message;
  Prototype drawn;
  for (int i = 0; i <= 500; ++i) {
    drawn.points.emplace_back(0.0002 * i, 0.001 * std::sin(0.1 * i), 0.001 * std::cos(0.1 * i));
  }
  EXPECT_EQ(FaultOf(drawn, 0.01), "p.points");
  EXPECT_EQ(FaultOf(drawn, 0.002), "");
}

// Wide curls have a longer outline than their axis; they are not refused, and not too long.
TEST(PrototypeTest, CurlsOfAnyWidthStayWithinTheMostDetails) {
  for (const StrandKind kind :
       {StrandKind::kWavy, StrandKind::kCurly, StrandKind::kFuzzy, StrandKind::kKinky}) {
    for (const double amplitude : {0.01, 0.1, 0.3, 1.0}) {
      const auto pattern = PrototypeDetails({kind, amplitude, 0, {}}, 1.2e-3, "prototype");
      ASSERT_TRUE(pattern) << pattern.error().message;
      EXPECT_LE(pattern->details.size(), static_cast<size_t>(kMostDetails));
    }
  }
}

}  // namespace
}  // namespace mane::styling
