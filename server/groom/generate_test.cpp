// Properties of generated guides:
//   scalp      every root lies on the scalp, n0 leaves it, and droop turns n0 toward the ground
//   length     the element lengths sum to the length asked for
//   preset     section, material and mean natural curvature are the preset's
//   variation  curl varies smoothly, by the amount asked for; none leaves equal guides
//   seed       same numbers, same bits; another seed, other guides
//   refusal    bad numbers are refused by name

#include "groom/generate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <complex>
#include <functional>
#include <limits>
#include <numbers>
#include <ostream>
#include <string>

#include "groom/presets.h"
#include "groom/resolution.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr HairType kTypes[] = {HairType::kAsianSmooth, HairType::kCaucasianWavy,
                               HairType::kCaucasianCurly, HairType::kAfricanFuzzy};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Ellipsoid Head() { return {{0, 0.1, 0.02}, {0.078, 0.11, 0.098}, {0, 1, -0.3}, 1.4}; }

Generation Request(HairType type) {
  Generation generation;
  generation.hair_type = type;
  generation.guide_count = 60;
  generation.length_m = 0.2;
  generation.seed = 17;
  return generation;
}

TEST(GenerateTest, MakesGuidesOfThePresetThatLeaveTheScalp) {
  const Ellipsoid head = Head();
  for (const HairType type : kTypes) {
    SCOPED_TRACE(int(type));
    const auto guides = Generate(head, Request(type), {});
    ASSERT_TRUE(guides) << guides.error().message;
    ASSERT_EQ(guides->size(), 60u);
    const Preset preset = PresetOf(type);
    for (const Guide& guide : *guides) {
      const Vector3d x = (guide.root.p - head.center).cwiseQuotient(head.radii);
      EXPECT_NEAR(x.norm(), 1, 1e-12);
      const Vector3d normal = x.cwiseQuotient(head.radii).normalized();
      const Vector3d n0 = guide.root.q * Vector3d::UnitX();
      EXPECT_GT(n0.dot(normal), std::cos(0.3 * pi / 2) - 1e-12);
      EXPECT_LE(n0.y(), normal.y() + 1e-12);
      EXPECT_NEAR(guide.root.q.norm(), 1, 1e-15);

      EXPECT_EQ(guide.strand.elements(),
                ElementCountFor(type, 0.2, kDefaultErrorTarget, guide.wound.has_value()));
      EXPECT_NEAR(guide.strand.TotalLength(), 0.2, 1e-16 * 32);
      EXPECT_EQ(guide.section.radius_1, preset.section.radius_1);
      EXPECT_EQ(guide.section.radius_2, preset.section.radius_2);
      EXPECT_EQ(guide.strand.stiffness, rod::Stiffness(preset.section, preset.material));
      EXPECT_EQ(guide.strand.internal_friction, preset.internal_friction);
      EXPECT_EQ(guide.strand.air_drag, preset.air_drag);
    }
  }
}

TEST(GenerateTest, TakesTheElementCountAsked) {
  Generation generation = Request(HairType::kCaucasianCurly);
  generation.element_count = 7;
  const auto guides = Generate(Head(), generation, {});
  ASSERT_TRUE(guides);
  for (const Guide& guide : *guides) {
    EXPECT_EQ(guide.strand.length,
              rod::GradedLengths(GradingOf(HairType::kCaucasianCurly, 0.2, true), 7));
  }
}

TEST(GenerateTest, TakesTheElementsThatTheErrorTargetNeeds) {
  Generation generation = Request(HairType::kCaucasianWavy);
  for (const double target : {0.2, 0.02, 0.005}) {
    generation.error_target = target;
    const auto guides = Generate(Head(), generation, {});
    ASSERT_TRUE(guides);
    EXPECT_EQ(guides->front().strand.elements(),
              ElementCountFor(HairType::kCaucasianWavy, 0.2, target, false));
  }
}

TEST(GenerateTest, GrowsOnHairTrianglesOnly) {
  // A tetrahedron whose hair grows on one face, in the plane x + y + z = 0.1.
  const TriangleMesh mesh{{{0, 0, 0}, {0.1f, 0, 0}, {0, 0.1f, 0}, {0, 0, 0.1f}},
                          {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}},
                          {3}};
  const auto guides = Generate(mesh, Request(HairType::kAsianSmooth), {});
  ASSERT_TRUE(guides);
  for (const Guide& guide : *guides) {
    EXPECT_NEAR(guide.root.p.sum(), 0.1, 1e-8);
    EXPECT_GE(guide.root.p.minCoeff(), -1e-12);
  }
}

TEST(GenerateTest, SameSeedSameBits) {
  for (const HairType type : kTypes) {
    const auto a = Generate(Head(), Request(type), {}), b = Generate(Head(), Request(type), {});
    ASSERT_TRUE(a);
    ASSERT_TRUE(b);
    for (size_t i = 0; i < a->size(); ++i) {
      EXPECT_EQ((*a)[i].root.p, (*b)[i].root.p);
      EXPECT_EQ((*a)[i].root.q.coeffs(), (*b)[i].root.q.coeffs());
      EXPECT_EQ((*a)[i].strand.natural, (*b)[i].strand.natural);
    }
  }
}

TEST(GenerateTest, OtherSeedOtherGuides) {
  Generation generation = Request(HairType::kCaucasianWavy);
  const auto a = Generate(Head(), generation, {});
  ++generation.seed;
  const auto b = Generate(Head(), generation, {});
  ASSERT_TRUE(a);
  ASSERT_TRUE(b);
  for (size_t i = 0; i < a->size(); ++i) {
    EXPECT_NE((*a)[i].root.p, (*b)[i].root.p);
    EXPECT_NE((*a)[i].strand.natural, (*b)[i].strand.natural);
  }
}

TEST(GenerateTest, CurlsStartInAllDirections) {
  Generation generation = Request(HairType::kCaucasianCurly);
  generation.guide_count = 400;
  generation.root_droop = 0;
  const auto guides = Generate(Head(), generation, {});
  ASSERT_TRUE(guides);
  // Mean of the directions of n1 about n0, as unit complex numbers: near zero for a uniform phase.
  std::complex<double> mean = 0;
  for (const Guide& guide : *guides) {
    const Vector3d n0 = guide.root.q * Vector3d::UnitX(), n1 = guide.root.q * Vector3d::UnitY();
    const Vector3d east = Vector3d::UnitY().cross(n0).normalized(), north = n0.cross(east);
    mean += std::complex<double>(n1.dot(east), n1.dot(north)) / 400.0;
  }
  EXPECT_LT(std::abs(mean), 0.15);  // Three standard deviations of 1 / sqrt(400).
}

TEST(RootFrameTest, DroopsAsStatedAtTheSideAndNotAtTheTop) {
  for (const double droop : {0.0, 0.3, 0.5, 1.0}) {
    SCOPED_TRACE(droop);
    const Vector3d side = RootFrame(Vector3d::UnitX(), droop, 0.4) * Vector3d::UnitX();
    const double angle = droop * pi / 2;
    EXPECT_LT((side - Vector3d(std::cos(angle), -std::sin(angle), 0)).norm(), 1e-12);
    for (const double y : {1.0, -1.0}) {
      const Vector3d level(0, y, 0);
      EXPECT_LT((RootFrame(level, droop, 0.4) * Vector3d::UnitX() - level).norm(), 1e-12);
    }
  }
}

TEST(RootFrameTest, IsARotationEverywhere) {
  math::RandomStream random(3, 0);
  for (int i = 0; i < 2000; ++i) {
    Vector3d normal(random.Normal(), random.Normal(), random.Normal());
    if (i % 4 == 0) normal = Vector3d(1e-12 * random.Normal(), i % 8 ? 1 : -1, 0);
    if (i % 4 == 1) normal = Vector3d(-1, 1e-14 * random.Normal(), 1e-12 * random.Normal());
    normal.normalize();
    const Eigen::Quaterniond q = RootFrame(normal, random.Uniform(), random.Uniform(0, 2 * pi));
    EXPECT_NEAR(q.norm(), 1, 1e-14);
    EXPECT_GT((q * Vector3d::UnitX()).dot(normal), -1e-12);  // Never into the head.
  }
}

TEST(RootFrameTest, PhaseTurnsAboutTheStrand) {
  const Vector3d normal = Vector3d(0.3, 0.5, -0.4).normalized();
  const Eigen::Quaterniond a = RootFrame(normal, 0.3, 0), b = RootFrame(normal, 0.3, 0.7);
  const Eigen::AngleAxisd turn(a.conjugate() * b);
  EXPECT_NEAR(turn.angle(), 0.7, 1e-12);
  EXPECT_LT((turn.axis() - Vector3d::UnitX()).norm(), 1e-12);
}

std::vector<double> Equal(int N) { return std::vector<double>(N, 0.2 / N); }

TEST(CurlVariationTest, IsTakenAtTheMiddleOfEachElement) {
  // The middle of the second of three elements is that of the only one.
  math::RandomStream a(7, 0), b(7, 0);
  const Vector3d mean(20, 100, 0);
  EXPECT_LT((CurlVariation(mean, 0.1, std::vector{0.05, 0.1, 0.05}, a)[1] -
             CurlVariation(mean, 0.1, Equal(1), b)[0])
                .norm(),
            1e-12);
}

TEST(CurlVariationTest, HasTheMeanAndSizeAsked) {
  const Vector3d mean(20, 100, 0);
  Vector3d sum = Vector3d::Zero(), squares = Vector3d::Zero();
  constexpr int kGuides = 4000, kElements = 10;
  for (uint64_t guide = 0; guide < kGuides; ++guide) {
    math::RandomStream random(1, guide);
    for (const Vector3d& natural : CurlVariation(mean, 0.05, Equal(kElements), random)) {
      const Vector3d deviation = natural - mean;
      sum += deviation / (kGuides * kElements);
      squares += deviation.cwiseAbs2() / (kGuides * kElements);
      EXPECT_LE(std::abs(deviation[1]), 0.05 * 100 * std::sqrt(6.0) * (1 + 1e-12));
    }
  }
  const Vector3d expected(0.05 * 20, 0.05 * 100, 0.05 * 100);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(sum[k] / expected[k], 0, 0.06);
    EXPECT_NEAR(std::sqrt(squares[k]) / expected[k], 1, 0.03);
  }
}

TEST(CurlVariationTest, IsSmoothAlongTheStrand) {
  // |f'| <= sqrt(2/3) 3 2 pi 2: neighbours of 100 elements differ by at most 0.31 of the size.
  math::RandomStream random(5, 0);
  const auto natural = CurlVariation({0, 1, 0}, 1, Equal(100), random);
  for (size_t Q = 1; Q < natural.size(); ++Q) {
    EXPECT_LT((natural[Q] - natural[Q - 1]).cwiseAbs().maxCoeff(), 0.31);
  }
}

TEST(CurlVariationTest, LeavesStraightHairStraightAndZeroLeavesTheMean) {
  math::RandomStream random(5, 0);
  for (const Vector3d& n : CurlVariation(Vector3d::Zero(), 1, Equal(10), random)) {
    EXPECT_EQ(n, Vector3d::Zero());
  }
  const Vector3d mean(20, 100, 0);
  for (const Vector3d& n : CurlVariation(mean, 0, Equal(10), random)) EXPECT_EQ(n, mean);
}

struct BadRequest {
  const char* name;
  std::function<void(Generation&)> spoil;
  const char* field;
  ErrorCode code = ErrorCode::kInvalidArgument;
  friend void PrintTo(const BadRequest& bad, std::ostream* out) { *out << bad.name; }
};

class BadGenerationTest : public ::testing::TestWithParam<BadRequest> {};

TEST_P(BadGenerationTest, IsRefusedByName) {
  Generation generation = Request(HairType::kCaucasianWavy);
  ASSERT_TRUE(Generate(Head(), generation, {}));
  GetParam().spoil(generation);
  const auto guides = Generate(Head(), generation, {});
  ASSERT_FALSE(guides);
  EXPECT_EQ(guides.error().code, GetParam().code);
  EXPECT_EQ(guides.error().field, std::string("header.generate.") + GetParam().field);
  EXPECT_NE(guides.error().message.find(GetParam().field), std::string::npos);
}

using G = Generation;

INSTANTIATE_TEST_SUITE_P(
    Table, BadGenerationTest,
    ::testing::Values(
        BadRequest{"NoType", [](G& g) { g.hair_type = HairType::kCustom; }, "hair_type"},
        BadRequest{"NoGuides", [](G& g) { g.guide_count = 0; }, "guide_count"},
        BadRequest{"TooManyGuides", [](G& g) { g.guide_count = 20001; }, "guide_count",
                   ErrorCode::kResourceExhausted},
        BadRequest{"AbsurdGuides", [](G& g) { g.guide_count = 0xffffffff; }, "guide_count",
                   ErrorCode::kResourceExhausted},
        BadRequest{"TooManyElements",
                   [](G& g) {
                     g.guide_count = 20000;
                     g.element_count = 21;
                   },
                   "guide_count", ErrorCode::kResourceExhausted},
        BadRequest{"ZeroLength", [](G& g) { g.length_m = 0; }, "length_m"},
        BadRequest{"NegativeLength", [](G& g) { g.length_m = -0.2; }, "length_m"},
        BadRequest{"NanLength", [](G& g) { g.length_m = kNan; }, "length_m"},
        BadRequest{"LongLength", [](G& g) { g.length_m = 6; }, "length_m"},
        BadRequest{"TinyLength", [](G& g) { g.length_m = 1e-9; }, "length_m"},
        BadRequest{"AbsurdElementCount", [](G& g) { g.element_count = 257; }, "element_count"},
        BadRequest{"TinyErrorTarget", [](G& g) { g.error_target = 1e-4; }, "error_target"},
        BadRequest{"LargeErrorTarget", [](G& g) { g.error_target = 0.5; }, "error_target"},
        BadRequest{"NanErrorTarget", [](G& g) { g.error_target = kNan; }, "error_target"},
        BadRequest{"ErrorTargetBesideElements",
                   [](G& g) {
                     g.element_count = 5;
                     g.error_target = 0.01;
                   },
                   "error_target"},
        BadRequest{"NegativeVariation", [](G& g) { g.curl_variation = -0.1; }, "curl_variation"},
        BadRequest{"LargeVariation", [](G& g) { g.curl_variation = 1.1; }, "curl_variation"},
        BadRequest{"NanVariation", [](G& g) { g.curl_variation = kNan; }, "curl_variation"},
        BadRequest{"LargeDroop", [](G& g) { g.root_droop = 2; }, "root_droop"},
        BadRequest{"NanDroop", [](G& g) { g.root_droop = kNan; }, "root_droop"},
        BadRequest{"LargeWisp", [](G& g) { g.wisp_radius_m = 0.2; }, "wisp_radius_m"}),
    [](const auto& bad) { return bad.param.name; });

TEST(GenerateTest, NeedsAValidScalp) {
  const auto none = Generate(std::monostate(), Request(HairType::kAsianSmooth), {});
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().field, "header.generate");
  Ellipsoid flat = Head();
  flat.radii.x() = 0;
  const auto bad = Generate(flat, Request(HairType::kAsianSmooth), {});
  ASSERT_FALSE(bad);
  EXPECT_EQ(bad.error().field, "header.ellipsoid.radii_m.x");
}

TEST(GenerateTest, TightCurlsAreWoundUnlessAskedOtherwise) {
  const Scalp scalp = Ellipsoid{{0, 0, 0}, {0.08, 0.11, 0.1}, {0, 1, 0}, 1.4};
  Generation generation;
  generation.guide_count = 8;
  generation.seed = 5;
  const auto wound = [&](HairType type, double length) {
    generation.hair_type = type;
    generation.length_m = length;
    const auto guides = Generate(scalp, generation, {});
    EXPECT_TRUE(guides);
    return std::ranges::count_if(*guides, [](const Guide& g) { return g.wound.has_value(); });
  };
  // Wavy hair turns 4.8 times in 0.3 m; curly 5.4 times in 0.2 m; fuzzy 30 times in 0.1 m.
  EXPECT_EQ(wound(HairType::kAsianSmooth, 0.3), 0);
  EXPECT_EQ(wound(HairType::kCaucasianWavy, 0.3), 0);
  EXPECT_EQ(wound(HairType::kCaucasianCurly, 0.1), 0);
  EXPECT_EQ(wound(HairType::kCaucasianCurly, 0.2), 8);
  EXPECT_EQ(wound(HairType::kAfricanFuzzy, 0.1), 8);
  // Twenty plain elements come nearer than a wound strand can, where they follow the turns.
  generation.error_target = 0.005;
  EXPECT_EQ(wound(HairType::kCaucasianCurly, 0.2), 0);
  EXPECT_EQ(wound(HairType::kAfricanFuzzy, 0.1), 8);
  generation.error_target.reset();
  generation.model = StrandModel::kSuperHelix;
  EXPECT_EQ(wound(HairType::kAfricanFuzzy, 0.1), 0);
  generation.model = StrandModel::kWound;
  EXPECT_EQ(wound(HairType::kCaucasianCurly, 0.3), 8);
  // Weight would unwind it: 5.6 turns of wide coils.
  EXPECT_EQ(wound(HairType::kCaucasianWavy, 0.35), 0);
  // Curl that varies by its own size is no coil.
  generation.curl_variation = 1;
  EXPECT_LT(wound(HairType::kAfricanFuzzy, 0.1), 8);
  generation.curl_variation = 0.05;
  generation.hair_type = HairType::kAsianSmooth;
  const auto straight = Generate(scalp, generation, {});
  ASSERT_FALSE(straight);
  EXPECT_EQ(straight.error().field, "header.generate.model");
  generation.model = static_cast<StrandModel>(7);
  const auto unknown = Generate(scalp, generation, {});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().field, "header.generate.model");
}

}  // namespace
}  // namespace mane::groom
