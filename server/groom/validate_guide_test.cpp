// Properties of MakeGuide and Describe:
//   refusal     every bad input is refused, and the error names the field and the value
//   bounds      the ends of every range are accepted or refused as mane.v1.Guide says
//   derivation  lengths, natural curvatures, stiffness and mass are what the description says
//   round trip  MakeGuide(Describe(guide)) is the same guide, bit for bit

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <numeric>
#include <ostream>
#include <string>

#include "groom/validate.h"
#include "math/random.h"

namespace mane::groom {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

GuideDescription Good() {
  GuideDescription d;
  d.root_position = {0.01, 0.12, -0.02};
  d.length_m = 0.2;
  d.element_count = 5;
  d.radius_1_m = 52e-6;
  d.radius_2_m = 48e-6;
  d.young_modulus_pa = 1e9;
  d.poisson_ratio = 0.48;
  d.density_kg_m3 = 1300;
  d.internal_friction = 1e-10;
  d.air_drag = 1e-5;
  d.natural_curvature_1 = {100};
  return d;
}

// One thing wrong, the field that must be named and a part of the message.
struct BadInput {
  const char* name;
  std::function<void(GuideDescription&)> spoil;
  std::string field;
  std::string says;
  friend void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }
};

class BadGuideTest : public ::testing::TestWithParam<BadInput> {};

TEST_P(BadGuideTest, IsRefusedByName) {
  GuideDescription d = Good();
  ASSERT_TRUE(MakeGuide(d, 12));
  GetParam().spoil(d);
  const Result<Guide> guide = MakeGuide(d, 12);
  ASSERT_FALSE(guide);
  EXPECT_EQ(guide.error().code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(guide.error().field, "guides[12]." + GetParam().field);
  EXPECT_THAT(guide.error().message, HasSubstr(GetParam().field));
  EXPECT_THAT(guide.error().message, HasSubstr(GetParam().says));
}

using D = GuideDescription;

INSTANTIATE_TEST_SUITE_P(
    Table, BadGuideTest,
    ::testing::Values(
        BadInput{"ZeroLength", [](D& d) { d.length_m = 0; }, "length_m", "is 0;"},
        BadInput{"NegativeLength", [](D& d) { d.length_m = -0.1; }, "length_m", "is -0.1;"},
        BadInput{"LongLength", [](D& d) { d.length_m = 5.1; }, "length_m", "[5e-06, 5] m"},
        BadInput{"NanLength", [](D& d) { d.length_m = kNan; }, "length_m", "is nan;"},
        BadInput{"InfiniteLength", [](D& d) { d.length_m = kInfinity; }, "length_m", "is inf;"},
        BadInput{"TinyLength", [](D& d) { d.length_m = 1e-300; }, "length_m", "1e-300"},
        BadInput{"NoElements", [](D& d) { d.element_count = 0; }, "element_count", "[1, 256]"},
        BadInput{"AbsurdElements", [](D& d) { d.element_count = 4'000'000'000; }, "element_count",
                 "is 4000000000;"},
        BadInput{"NegativeElementLength",
                 [](D& d) {
                   d.element_lengths_m = {.1, -.1, .1, .1, .0};
                 },
                 "element_lengths_m[1]", "is -0.1;"},
        BadInput{"NanElementLength",
                 [](D& d) {
                   d.element_lengths_m = {.1, .1, kNan, .1, .1};
                 },
                 "element_lengths_m[2]", "is nan;"},
        BadInput{"ZeroElementLength",
                 [](D& d) {
                   d.element_lengths_m = {0, .05, .05, .05, .05};
                 },
                 "element_lengths_m[0]", "[1e-06, 5] m"},
        BadInput{"ElementLengthsOfAnotherSum",
                 [](D& d) {
                   d.element_lengths_m = {.04, .04, .04, .04, .05};
                 },
                 "length_m", "0.21"},
        BadInput{"NanLengthBesideElementLengths",
                 [](D& d) {
                   d.element_lengths_m = {.04, .04, .04, .04, .04};
                   d.length_m = kNan;
                 },
                 "length_m", "is nan;"},
        BadInput{"ElementLengthsOfAnotherCount",
                 [](D& d) {
                   d.element_lengths_m = {.05, .05, .05, .05};
                 },
                 "element_count", "is 5;"},
        BadInput{"TooManyElementLengths",
                 [](D& d) {
                   d.element_lengths_m.assign(257, 1e-3);
                   d.element_count = 257;
                   d.length_m = 0.257;
                 },
                 "element_lengths_m", "257"},
        BadInput{"LongSumOfElementLengths",
                 [](D& d) {
                   d.element_lengths_m.assign(5, 2);
                   d.length_m = 0;
                 },
                 "element_lengths_m", "10 m"},
        BadInput{"NanPosition", [](D& d) { d.root_position.y() = kNan; }, "root_position.y", "nan"},
        BadInput{"FarPosition", [](D& d) { d.root_position.z() = -2e6; }, "root_position.z",
                 "is -2000000"},
        BadInput{"LongQuaternion", [](D& d) { d.root_frame.coeffs() << 0, 0, 0, 1.02; },
                 "root_frame", "norm 1.02"},
        BadInput{"ShortQuaternion", [](D& d) { d.root_frame.coeffs() << 0.98, 0, 0, 0; },
                 "root_frame", "norm 0.98"},
        BadInput{"ZeroQuaternion", [](D& d) { d.root_frame.coeffs().setZero(); }, "root_frame",
                 "norm 0;"},
        BadInput{"NanQuaternion", [](D& d) { d.root_frame.x() = kNan; }, "root_frame", "nan"},
        BadInput{"InfiniteQuaternion", [](D& d) { d.root_frame.w() = kInfinity; }, "root_frame",
                 "inf"},
        BadInput{"ZeroRadius", [](D& d) { d.radius_1_m = 0; }, "radius_1_m", "[1e-06, 0.01] m"},
        BadInput{"NegativeRadius", [](D& d) { d.radius_2_m = -50e-6; }, "radius_2_m", "-5e-05"},
        BadInput{"NanRadius", [](D& d) { d.radius_2_m = kNan; }, "radius_2_m", "nan"},
        BadInput{"SoftModulus", [](D& d) { d.young_modulus_pa = 0; }, "young_modulus_pa", "Pa"},
        BadInput{"NanModulus", [](D& d) { d.young_modulus_pa = kNan; }, "young_modulus_pa", "nan"},
        BadInput{"PoissonOfMinusOne", [](D& d) { d.poisson_ratio = -1; }, "poisson_ratio",
                 "(-1, 0.5]"},
        BadInput{"LargePoisson", [](D& d) { d.poisson_ratio = 0.51; }, "poisson_ratio", "0.51"},
        BadInput{"NanPoisson", [](D& d) { d.poisson_ratio = kNan; }, "poisson_ratio", "nan"},
        BadInput{"ZeroDensity", [](D& d) { d.density_kg_m3 = 0; }, "density_kg_m3", "kg/m^3"},
        BadInput{"InfiniteDensity", [](D& d) { d.density_kg_m3 = kInfinity; }, "density_kg_m3",
                 "inf"},
        BadInput{"NegativeFriction", [](D& d) { d.internal_friction = -1e-10; },
                 "internal_friction", "-1e-10"},
        BadInput{"NanFriction", [](D& d) { d.internal_friction = kNan; }, "internal_friction",
                 "nan"},
        BadInput{"NegativeDrag", [](D& d) { d.air_drag = -1; }, "air_drag", "[0, 10]"},
        BadInput{"NanDrag", [](D& d) { d.air_drag = kNan; }, "air_drag", "nan"},
        BadInput{"NegativeWisp", [](D& d) { d.wisp_radius_m = -1e-3; }, "wisp_radius_m",
                 "[0, 0.1] m"},
        BadInput{"NanWisp", [](D& d) { d.wisp_radius_m = kNan; }, "wisp_radius_m", "nan"},
        BadInput{"NanTwist", [](D& d) { d.natural_twist = {0, 0, 0, kNan, 0}; }, "natural_twist[3]",
                 "nan"},
        BadInput{"LargeCurvature", [](D& d) { d.natural_curvature_1 = {2e5}; },
                 "natural_curvature_1[0]", "[-100000, 100000] rad/m"},
        BadInput{"InfiniteCurvature", [](D& d) { d.natural_curvature_2 = {-kInfinity}; },
                 "natural_curvature_2[0]", "-inf"},
        BadInput{"CurvaturesOfAnotherCount", [](D& d) { d.natural_curvature_1 = {1, 2, 3}; },
                 "natural_curvature_1", "none, one or 5"}),
    [](const auto& bad) { return bad.param.name; });

TEST(MakeGuideTest, AcceptsTheEndsOfEveryRange) {
  for (const bool low : {true, false}) {
    SCOPED_TRACE(low);
    GuideDescription d = Good();
    d.element_count = low ? 1 : 256;
    d.length_m = low ? 1e-6 : 5;
    d.radius_1_m = d.radius_2_m = low ? 1e-6 : 1e-2;
    d.young_modulus_pa = low ? 1e4 : 1e13;
    d.poisson_ratio = low ? -0.999 : 0.5;
    d.density_kg_m3 = low ? 1 : 1e5;
    d.internal_friction = low ? 0 : 1;
    d.air_drag = low ? 0 : 10;
    d.wisp_radius_m = low ? 0 : 0.1;
    d.natural_twist = {low ? -1e5 : 1e5};
    const auto guide = MakeGuide(d, 0);
    EXPECT_TRUE(guide) << guide.error().message;
  }
}

TEST(MakeGuideTest, SplitsTheLengthEquallyOrAsTold) {
  GuideDescription d = Good();
  EXPECT_EQ(MakeGuide(d, 0)->strand.length, std::vector<double>(5, 0.2 / 5));
  d.element_lengths_m = {0.02, 0.03, 0.04, 0.05, 0.06};
  EXPECT_EQ(MakeGuide(d, 0)->strand.length, d.element_lengths_m);
  d.element_count = 0;
  d.length_m = 0;
  EXPECT_EQ(MakeGuide(d, 0)->strand.length, d.element_lengths_m);
  EXPECT_NEAR(MakeGuide(d, 0)->strand.TotalLength(), 0.2, 1e-16);
}

TEST(MakeGuideTest, NormalisesAQuaternionWithinOnePercent) {
  GuideDescription d = Good();
  d.root_frame.coeffs() << 0.3, -0.5, 0.1, 0.8;
  const Eigen::Quaterniond unit = d.root_frame.normalized();
  for (const double scale : {0.991, 1.009}) {
    d.root_frame.coeffs() = scale * unit.coeffs();
    const auto guide = MakeGuide(d, 0);
    ASSERT_TRUE(guide);
    EXPECT_NEAR(guide->root.q.norm(), 1, 1e-15);
    EXPECT_LT((guide->root.q.coeffs() - unit.coeffs()).norm(), 1e-15);
  }
}

TEST(MakeGuideTest, SpreadsNaturalCurvaturesOverTheElements) {
  GuideDescription d = Good();
  d.natural_twist = {};
  d.natural_curvature_1 = {7};
  d.natural_curvature_2 = {1, 2, 3, 4, 5};
  const auto guide = MakeGuide(d, 0);
  ASSERT_TRUE(guide);
  for (int Q = 0; Q < 5; ++Q) {
    EXPECT_EQ(guide->strand.natural[Q], Eigen::Vector3d(0, 7, Q + 1));
  }
}

TEST(MakeGuideTest, DerivesStiffnessAndMassFromTheSection) {
  const GuideDescription d = Good();
  const auto guide = MakeGuide(d, 0);
  ASSERT_TRUE(guide);
  const double pi = 3.14159265358979323846, a = 52e-6, b = 48e-6;
  const Eigen::Vector3d EI = guide->strand.stiffness;
  EXPECT_NEAR(EI[1] / (1e9 * pi / 4 * a * b * b * b), 1, 1e-14);
  EXPECT_NEAR(EI[2] / (1e9 * pi / 4 * a * a * a * b), 1, 1e-14);
  const double J = pi * a * a * a * b * b * b / (a * a + b * b);
  EXPECT_NEAR(EI[0] / (1e9 / (2 * 1.48) * J), 1, 1e-14);
  EXPECT_NEAR(guide->strand.linear_density / (1300 * pi * a * b), 1, 1e-14);
  EXPECT_EQ(guide->strand.internal_friction, 1e-10);
  EXPECT_EQ(guide->strand.air_drag, 1e-5);
}

void ExpectSame(const Guide& a, const Guide& b) {
  EXPECT_EQ(a.root.p, b.root.p);
  EXPECT_EQ(a.root.q.coeffs(), b.root.q.coeffs());
  EXPECT_EQ(a.section.radius_1, b.section.radius_1);
  EXPECT_EQ(a.section.radius_2, b.section.radius_2);
  EXPECT_EQ(a.material.young_modulus, b.material.young_modulus);
  EXPECT_EQ(a.material.poisson_ratio, b.material.poisson_ratio);
  EXPECT_EQ(a.material.density, b.material.density);
  EXPECT_EQ(a.strand.length, b.strand.length);
  EXPECT_EQ(a.strand.natural, b.strand.natural);
  EXPECT_EQ(a.strand.stiffness, b.strand.stiffness);
  EXPECT_EQ(a.strand.linear_density, b.strand.linear_density);
  EXPECT_EQ(a.strand.internal_friction, b.strand.internal_friction);
  EXPECT_EQ(a.strand.air_drag, b.strand.air_drag);
  EXPECT_EQ(a.wisp_radius, b.wisp_radius);
}

TEST(DescribeTest, RoundTripIsExact) {
  math::RandomStream random(20240117, 0);
  for (int i = 0; i < 2000; ++i) {
    SCOPED_TRACE(i);
    GuideDescription d = Good();
    d.element_count = 1 + random.Bits() % 30;
    d.length_m = random.Uniform(0.01, 1);
    for (double& c : d.root_frame.coeffs()) c = random.Normal();
    d.root_frame.normalize();
    d.root_frame.coeffs() *= random.Uniform(0.991, 1.009);
    d.radius_1_m = random.Uniform(1e-5, 1e-4);
    d.wisp_radius_m = random.Uniform(0, 0.1);
    if (i % 2) {
      for (uint32_t Q = 0; Q < d.element_count; ++Q) {
        d.natural_twist.push_back(random.Normal());
      }
    }
    if (i % 3 == 0) d.natural_curvature_1 = {-0.0};
    if (i % 5 == 0) {
      for (uint32_t Q = 0; Q < d.element_count; ++Q) {
        d.element_lengths_m.push_back(random.Uniform(0.01, 0.02));
      }
      d.length_m = std::accumulate(d.element_lengths_m.begin(), d.element_lengths_m.end(), 0.0);
    }
    const auto guide = MakeGuide(d, 0);
    ASSERT_TRUE(guide) << guide.error().message;
    const auto again = MakeGuide(Describe(*guide), 0);
    ASSERT_TRUE(again) << again.error().message;
    ExpectSame(*guide, *again);
  }
}

TEST(DescribeTest, LengthsAtTheirLimitsRoundTripToo) {
  for (const double length : {5.0, 256e-6}) {
    for (uint32_t N = 1; N <= 256; ++N) {
      GuideDescription d = Good();
      d.length_m = length;
      d.element_count = N;
      const auto guide = MakeGuide(d, 0);
      ASSERT_TRUE(guide) << N;
      const auto again = MakeGuide(Describe(*guide), 0);
      ASSERT_TRUE(again) << N << ": " << again.error().message;
      ExpectSame(*guide, *again);
    }
  }
}

TEST(DescribeTest, SaysEqualThingsOnce) {
  const GuideDescription d = Describe(*MakeGuide(Good(), 0));
  EXPECT_EQ(d.length_m, 0.2);
  EXPECT_EQ(d.element_count, 5u);
  EXPECT_TRUE(d.element_lengths_m.empty());
  EXPECT_TRUE(d.natural_twist.empty());
  EXPECT_EQ(d.natural_curvature_1, std::vector<double>{100});
}

}  // namespace
}  // namespace mane::groom
