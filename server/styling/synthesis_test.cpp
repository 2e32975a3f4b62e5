// Laws of the synthesis of master strands:
//   T = 0        repeats the prototype, and a periodic one for many periods beyond its end
//   T -> 0       comes to that, continuously
//   T grows      strands differ more and more, and follow the prototype less and less
//   Gibbs        candidates are drawn with the probabilities of (4)
//   root         every strand starts in its root

#include "styling/synthesis.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>

#include "math/random.h"

namespace mane::styling {
namespace {

using Eigen::Vector3f;

PrototypeModel Model(const Pattern& pattern, double temperature, int window = 0) {
  Synthesis synthesis;
  synthesis.temperature = temperature;
  synthesis.window = window;
  auto model = PrototypeModel::Make(pattern, synthesis, "s");
  EXPECT_TRUE(model.has_value()) << model.error().message;
  return *model;
}

Pattern Helix(double points_a_turn, int m) {
  Pattern pattern;
  pattern.structure = static_cast<int>(std::lround(points_a_turn));
  for (int i = 0; i < m; ++i) {
    const auto angle = static_cast<float>(2 * std::numbers::pi * i / points_a_turn);
    pattern.details.emplace_back(0, 0.01F * std::cos(angle), 0.01F * std::sin(angle));
  }
  return pattern;
}

Pattern Curly(double segment_length = 0.003) {
  return *PrototypeDetails({StrandKind::kCurly, 0, 0, {}}, segment_length, "p");
}

std::vector<Vector3f> Strand(const PrototypeModel& model, uint64_t stream, int joints) {
  std::vector<Vector3f> details(joints);
  Synthesize(model, 11, stream, details);
  return details;
}

// Over 400 strands: mean square deviation of joints from their mean [m^2].
double Diversity(const Pattern& pattern, double temperature) {
  const PrototypeModel model = Model(pattern, temperature);
  constexpr int kStrands = 400, kJoints = 60;
  std::vector<Vector3f> mean(kJoints, Vector3f::Zero());
  double square = 0, square_of_mean = 0;
  for (int s = 0; s < kStrands; ++s) {
    const auto details = Strand(model, s, kJoints);
    for (int i = 0; i < kJoints; ++i) {
      mean[i] += details[i] / kStrands;
      square += details[i].squaredNorm() / (kStrands * kJoints);
    }
  }
  for (const Vector3f& x : mean) square_of_mean += x.squaredNorm() / kJoints;
  return square - square_of_mean;
}

TEST(SynthesisTest, RepeatsTheWholePrototypeAtTemperatureZero) {
  const Pattern pattern = Curly();
  const auto details = Strand(Model(pattern, 0), 0, static_cast<int>(pattern.details.size()));
  for (size_t i = pattern.structure; i < details.size(); ++i) {
    EXPECT_EQ(details[i], pattern.details[i]);
  }
}

TEST(SynthesisTest, APeriodicPrototypeGoesOnForManyPeriods) {
  const Pattern pattern = Helix(9, 20);
  const auto details = Strand(Model(pattern, 0), 0, 200);
  const Pattern longer = Helix(9, 200);
  for (int i = 9; i < 200; ++i) EXPECT_LT((details[i] - longer.details[i]).norm(), 1e-6F);
}

TEST(SynthesisTest, APeriodThatIsNoWholeNumberOfPointsGoesOnToo) {
  // 9.4 points a turn: phases drift by up to 1/5 of a point at every jump back, and correct.
  const auto details = Strand(Model(Helix(9.4, 60), 0), 0, 400);
  for (int i = 10; i + 1 < 400; ++i) {
    const float angle = std::acos(details[i].normalized().dot(details[i + 1].normalized()));
    EXPECT_NEAR(angle, 2 * std::numbers::pi / 9.4, 0.25 * 2 * std::numbers::pi / 9.4);
  }
}

TEST(SynthesisTest, StrandsStartInTheirRoots) {
  const Pattern pattern = Curly();
  for (double temperature : {0.0, 0.1, 10.0}) {
    const auto details = Strand(Model(pattern, temperature), 3, 30);
    EXPECT_EQ(details[0], Vector3f::Zero());
    // A smooth step t^2 (3 - 2 t) of t = 1 / structure.
    EXPECT_LT(details[1].norm(), 3.0F / (pattern.structure * pattern.structure) * 0.012F);
  }
}

TEST(SynthesisTest, StraightHairStaysStraight) {
  for (const Vector3f& delta : Strand(Model({{Vector3f::Zero()}, 0}, 1), 0, 20)) {
    EXPECT_EQ(delta, Vector3f::Zero());
  }
}

TEST(SynthesisTest, ColdStrandsComeToTheDeterministicOne) {
  const Pattern pattern = Curly();
  EXPECT_EQ(Strand(Model(pattern, 1e-9), 5, 90), Strand(Model(pattern, 0), 0, 90));
  EXPECT_EQ(Strand(Model(pattern, 1e-300), 5, 90), Strand(Model(pattern, 0), 0, 90));
}

TEST(SynthesisTest, DiversityGrowsWithTheTemperature) {
  const Pattern pattern = Curly();
  double last = Diversity(pattern, 0);
  EXPECT_LT(last, 1e-12);
  for (double temperature : {0.03, 0.12, 0.6, 3.0}) {
    const double diversity = Diversity(pattern, temperature);
    EXPECT_GT(diversity, last) << temperature;
    last = diversity;
  }
}

TEST(SynthesisTest, CandidatesHaveTheProbabilitiesOfGibbs) {
  // Without a structure details are not faded in, and with h = 1 the second detail is drawn given
  // the first alone: P_k ~ exp(-|delta_0 - delta_{k-1}| / (T rms)).
  Pattern pattern;
  for (float x : {1.0F, 3.0F, 2.0F, 0.5F, 1.2F}) pattern.details.emplace_back(x, 0, 0);
  const double T = 0.5;
  const PrototypeModel model = Model(pattern, T, 1);
  std::array<double, 5> expected{}, drawn{};
  double Z = 0;
  for (int k = 1; k < 5; ++k) {
    Z += expected[k] = std::exp(-std::abs(1 - pattern.details[k - 1].x()) / (T * model.rms()));
  }
  constexpr int kDraws = 100000;
  for (int s = 0; s < kDraws; ++s) {
    const float x = Strand(model, s, 2)[1].x();
    for (int k = 1; k < 5; ++k) drawn[k] += x == pattern.details[k].x() ? 1.0 / kDraws : 0;
  }
  for (int k = 1; k < 5; ++k) {  // Four standard deviations of a proportion.
    EXPECT_NEAR(drawn[k], expected[k] / Z, 4 * 0.5 / std::sqrt(kDraws));
  }
}

TEST(SynthesisTest, WindowsCompareTheirWholePast) {
  // Brute force at T = 0: every detail follows the window that is nearest to the strand's last h.
  math::RandomStream random(2, 0);
  Pattern pattern;
  for (int i = 0; i < 40; ++i) {
    pattern.details.emplace_back(
        Eigen::Vector3d(random.Normal(), random.Normal(), 0).cast<float>());
  }
  const int h = 3, m = 40;
  const auto details = Strand(Model(pattern, 0, h), 0, 120);
  for (int i = h; i < 120; ++i) {
    double least = 1e9;
    int best = -1;
    for (int k = h; k < m; ++k) {
      double sum = 0;
      for (int t = 1; t <= h; ++t) {
        // Joint 0 alone is faded: its detail is the prototype's first.
        const Vector3f past = i == t ? pattern.details[0] : details[i - t];
        sum += (past - pattern.details[k - t]).squaredNorm();
      }
      if (sum < least) least = sum, best = k;
    }
    EXPECT_EQ(details[i], pattern.details[best]) << i;
  }
}

TEST(SynthesisTest, AStrandDependsOnItsStreamOnly) {
  const PrototypeModel model = Model(Curly(), 0.1);
  EXPECT_EQ(Strand(model, 1, 80), Strand(model, 1, 80));
  EXPECT_NE(Strand(model, 1, 80), Strand(model, 2, 80));
  const auto shorter = Strand(model, 1, 50), longer = Strand(model, 1, 80);
  EXPECT_TRUE(std::equal(shorter.begin(), shorter.end(), longer.begin()));
}

TEST(SynthesisTest, FaultsAreNamed) {
  const auto field = [](int window, double temperature) {
    Synthesis synthesis;
    synthesis.window = window;
    synthesis.temperature = temperature;
    const auto model = PrototypeModel::Make(Helix(9, 20), synthesis, "s");
    return model ? "" : model.error().field;
  };
  EXPECT_EQ(field(10, 0), "");
  EXPECT_EQ(field(11, 0), "s.window");
  EXPECT_EQ(field(-1, 0), "s.window");
  EXPECT_EQ(field(0, -0.1), "s.temperature");
  EXPECT_EQ(field(0, std::nan("")), "s.temperature");
}

}  // namespace
}  // namespace mane::styling
