// Properties of the choice of elements:
//   target    a preset's tip is as near to the converged strand's as asked, at rest and in a shake
//             of the head, wherever fewer than the most elements were chosen
//   fewest    a wider target takes no more elements, and straight hair of any length takes few
//   wound     wound hair takes 5 or 10

#include "groom/resolution.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rod/test_shake.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

constexpr HairType kTypes[] = {HairType::kAsianSmooth, HairType::kCaucasianWavy,
                               HairType::kCaucasianCurly, HairType::kAfricanFuzzy};

TEST(ResolutionTest, ReachesTheTargetAtRestAndInMotion) {
  int reached = 0;
  for (const HairType type : kTypes) {
    for (const double length : {0.02, 0.05, 0.1, 0.2, 0.3, 0.5}) {
      for (const double target : {0.02, 0.01, 0.004}) {
        const int N = ElementCountFor(type, length, target, false);
        if (N == kMostElements) continue;
        ++reached;
        const rod::Strand strand = PresetStrand(type, length, N),
                          converged = PresetStrand(type, length, 120);
        double rest = 0, motion = 0;
        const std::vector<math::Pose> roots = rod::fixtures::SideRoots();
        for (const math::Pose& root : roots) {
          using namespace rod::fixtures;
          rest += (TipOf(strand, root, AtRest(strand, root).theta) -
                   TipOf(converged, root, AtRest(converged, root).theta))
                      .squaredNorm() /
                  static_cast<double>(roots.size());
          motion +=
              std::pow(RmsDistance(ShakenTips(strand, root), ShakenTips(converged, root)), 2) /
              static_cast<double>(roots.size());
        }
        EXPECT_LE(std::sqrt(rest) / length, target) << int(type) << " " << length << " " << N;
        EXPECT_LE(std::sqrt(motion) / length, target) << int(type) << " " << length << " " << N;
      }
    }
  }
  EXPECT_GE(reached, 40);
}

TEST(ResolutionTest, TakesFewElementsAndNoMoreForAWiderTarget) {
  for (const HairType type : kTypes) {
    for (const double length : {0.05, 0.1, 0.2, 0.3}) {
      int last = kMostElements;
      for (const double target : {0.002, 0.005, 0.01, 0.02, 0.05, 0.2}) {
        const int N = ElementCountFor(type, length, target, false);
        EXPECT_LE(N, last) << int(type) << " " << length << " " << target;
        EXPECT_GE(N, kFewestElements);
        last = N;
      }
    }
  }
  for (const double length : {0.1, 0.3, 1.0}) {
    EXPECT_EQ(ElementCountFor(HairType::kAsianSmooth, length, kDefaultErrorTarget, false), 6);
  }
  EXPECT_EQ(ElementCountFor(HairType::kAfricanFuzzy, 0.1, kDefaultErrorTarget, false),
            kMostElements);
}

TEST(ResolutionTest, WoundHairTakesFiveOrTen) {
  EXPECT_EQ(ElementCountFor(HairType::kAfricanFuzzy, 0.1, 0.02, true), 5);
  EXPECT_EQ(ElementCountFor(HairType::kAfricanFuzzy, 0.1, 0.01, true), 10);
}

TEST(ResolutionTest, PresetStrandIsThePresets) {
  for (const HairType type : kTypes) {
    const rod::Strand strand = PresetStrand(type, 0.2, 7);
    EXPECT_EQ(strand.elements(), 7);
    EXPECT_NEAR(strand.TotalLength(), 0.2, 1e-15);
    EXPECT_EQ(strand.length, rod::GradedLengths(GradingOf(type, 0.2, false), 7));
  }
}

}  // namespace
}  // namespace mane::groom
