// Properties of Assemble:
//   indices  first_element counts the elements of all guides
//   rest     rest angles are an equilibrium: no unbalanced moment, less energy than the natural
//            shape; a hanging straight strand stays straight
//   workers  the same bits without a pool and with pools of any size
//   limits   guides of many elements are admitted by the number of elements, as they are solved
//   kept     rest angles from storage are taken as they are
//   refusal  empty, too large, or ill-fitting parts are refused by name

#include "groom/assemble.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <limits>
#include <numbers>

#include "groom/generate.h"
#include "groom/validate.h"
#include "rod/energy.h"
#include "rod/wound_shape.h"

namespace mane::groom {
namespace {

using Eigen::Vector3d;

const Vector3d kGravity(0, -9.81, 0);

Parts Generated(HairType type, uint32_t guides) {
  Parts parts;
  parts.display_name = "test";
  parts.hair_type = type;
  parts.seed = 3;
  parts.scalp = Ellipsoid{{0, 0, 0}, {0.08, 0.11, 0.1}, {0, 1, 0}, 1.4};
  Generation generation;
  generation.hair_type = type;
  generation.guide_count = guides;
  generation.length_m = 0.15;
  generation.seed = 3;
  parts.guides = *Generate(parts.scalp, generation, {});
  return parts;
}

GuideDescription Straight(const Eigen::Quaterniond& root) {
  GuideDescription d;
  d.root_frame = root;
  d.length_m = 0.2;
  d.element_count = 4;
  d.radius_1_m = d.radius_2_m = 50e-6;
  d.young_modulus_pa = 1e9;
  d.poisson_ratio = 0.48;
  d.density_kg_m3 = 1300;
  return d;
}

// A wound guide's rest: no force by any unknown, and less energy than the natural shape has.
void ExpectWoundRest(const Guide& guide, std::span<const double> rest) {
  const auto energy = [&](std::span<const rod::Vector4d> x) {
    return rod::ElasticEnergy(*guide.wound, x) +
           rod::GravityPotential(*guide.wound, guide.root, kGravity, x);
  };
  std::vector<rod::Vector4d> x(guide.strand.elements());
  for (size_t Q = 0; Q < x.size(); ++Q) x[Q] = Eigen::Map<const rod::Vector4d>(&rest[4 * Q]);
  EXPECT_LT(energy(x), energy(guide.wound->natural));
  const double moment = 0.5 * guide.strand.linear_density * 9.81 * 0.15 * 0.15, step = 1e-4;
  for (size_t Q = 0; Q < x.size(); ++Q) {
    for (int i = 0; i < 4; ++i) {
      std::vector<rod::Vector4d> more = x, less = x;
      more[Q][i] += step;
      less[Q][i] -= step;
      EXPECT_LT(std::abs(energy(more) - energy(less)) / (2 * step), 1e-5 * moment);
    }
  }
}

TEST(AssembleTest, CountsElements) {
  Parts parts;
  for (const uint32_t N : {3, 1, 5}) {
    GuideDescription d = Straight(Eigen::Quaterniond::Identity());
    d.element_count = N;
    parts.guides.push_back(*MakeGuide(d, 0));
  }
  const auto groom = Assemble(std::move(parts), {}, nullptr);
  ASSERT_TRUE(groom);
  EXPECT_EQ((*groom)->first_element, (std::vector<int>{0, 3, 4, 9}));
  EXPECT_EQ((*groom)->guide_count(), 3);
  EXPECT_EQ((*groom)->element_count(), 9);
  EXPECT_EQ((*groom)->first_coordinate, (std::vector<int>{0, 9, 12, 27}));
  EXPECT_EQ((*groom)->rest.size(), 27u);
}

TEST(AssembleTest, FindsTheEquilibriumOfEveryGuide) {
  for (const HairType type : {HairType::kAsianSmooth, HairType::kCaucasianWavy,
                              HairType::kCaucasianCurly, HairType::kAfricanFuzzy}) {
    SCOPED_TRACE(int(type));
    const auto groom = Assemble(Generated(type, 6), {}, nullptr);
    ASSERT_TRUE(groom);
    EXPECT_EQ((*groom)->hair_type, type);
    EXPECT_EQ((*groom)->display_name, "test");
    EXPECT_EQ((*groom)->seed, 3u);
    for (int i = 0; i < (*groom)->guide_count(); ++i) {
      SCOPED_TRACE(i);
      const Guide& guide = (*groom)->guides[i];
      const int N = guide.strand.elements();
      if (guide.wound) {
        ExpectWoundRest(guide, (*groom)->rest_of(i));
        continue;
      }
      const std::span<const double> rest = (*groom)->rest_of(i);
      std::vector<Vector3d> theta(N);
      for (int Q = 0; Q < N; ++Q) theta[Q] = Eigen::Map<const Vector3d>(&rest[3 * Q]);
      std::vector<Vector3d> gradient(N), natural(N);
      rod::PotentialGradient(guide.strand, guide.root, kGravity, theta, gradient);
      // Against the largest moment that the weight can exert.
      const double moment = 0.5 * guide.strand.linear_density * 9.81 * 0.15 * 0.15;
      for (const Vector3d& g : gradient) EXPECT_LT(g.cwiseAbs().maxCoeff(), 1e-6 * moment);
      for (int Q = 0; Q < N; ++Q) natural[Q] = guide.strand.length[Q] * guide.strand.natural[Q];
      const auto energy = [&](std::span<const Vector3d> angles) {
        return rod::ElasticEnergy(guide.strand, angles) +
               rod::GravityPotential(guide.strand, guide.root, kGravity, angles);
      };
      EXPECT_LT(energy(theta), energy(natural));
    }
  }
}

TEST(AssembleTest, AHangingStraightStrandStaysStraight) {
  Parts parts;
  const auto down = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), -Vector3d::UnitY());
  parts.guides.push_back(*MakeGuide(Straight(down), 0));
  const auto groom = Assemble(std::move(parts), {}, nullptr);
  ASSERT_TRUE(groom);
  for (const double angle : (*groom)->rest) EXPECT_LT(std::abs(angle), 1e-9);
}

TEST(AssembleTest, BitsDoNotDependOnTheWorkers) {
  const auto alone = Assemble(Generated(HairType::kCaucasianWavy, 9), {}, nullptr);
  ASSERT_TRUE(alone);
  for (const int workers : {1, 2, 3}) {
    exec::WorkerPool pool(workers);
    const auto groom = Assemble(Generated(HairType::kCaucasianWavy, 9), {}, &pool);
    ASSERT_TRUE(groom);
    EXPECT_EQ((*groom)->rest, (*alone)->rest);
  }
}

TEST(AssembleTest, TakesKeptRestAngles) {
  Parts parts = Generated(HairType::kAsianSmooth, 2);
  parts.rest.assign(2 * parts.guides[0].coordinate_count(), 1.5);
  const auto kept = parts.rest;
  const auto groom = Assemble(std::move(parts), {}, nullptr);
  ASSERT_TRUE(groom);
  EXPECT_EQ((*groom)->rest, kept);
}

TEST(AssembleTest, RefusesRestAnglesThatDoNotFit) {
  Parts parts = Generated(HairType::kAsianSmooth, 2);
  parts.rest.assign(3, 0);
  const auto few = Assemble(parts, {}, nullptr);
  ASSERT_FALSE(few);
  EXPECT_EQ(few.error().field, "rest");
  parts.rest.assign(2 * parts.guides[0].coordinate_count(), 0);
  parts.rest[14] = std::numeric_limits<double>::quiet_NaN();
  const auto nan = Assemble(parts, {}, nullptr);
  ASSERT_FALSE(nan);
  EXPECT_EQ(nan.error().field, "rest");
}

TEST(AssembleTest, GuidesOfTheMostElementsCountByTheirElements) {
  const int most = Limits().max_elements / kMaxElementsPerGuide;
  GuideDescription d = Straight(Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), kGravity));
  d.element_count = kMaxElementsPerGuide;
  Parts parts;
  parts.guides.assign(100, *MakeGuide(d, 0));
  const auto groom = Assemble(parts, {}, nullptr);
  ASSERT_TRUE(groom) << groom.error().message;
  EXPECT_EQ((*groom)->element_count(), 100 * kMaxElementsPerGuide);
  parts.guides.assign(most + 1, parts.guides.front());
  EXPECT_FALSE(Assemble(std::move(parts), {}, nullptr));
}

TEST(AssembleTest, RefusesEmptyHugeAndInvalidGrooms) {
  const Parts good = Generated(HairType::kAsianSmooth, 3);
  const auto refused = [](Parts parts, const Limits& limits) {
    const auto groom = Assemble(std::move(parts), limits, nullptr);
    EXPECT_FALSE(groom);
    return groom ? Error{} : groom.error();
  };

  Parts parts = good;
  parts.guides.clear();
  EXPECT_EQ(refused(parts, {}).code, ErrorCode::kInvalidArgument);
  EXPECT_EQ(refused(parts, {}).field, "guides");

  Limits limits;
  limits.max_guides = 2;
  EXPECT_EQ(refused(good, limits).code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(refused(good, limits).field, "guides");

  limits = {};
  limits.max_elements = 14;  // The three guides have 5 each.
  EXPECT_EQ(refused(good, limits).code, ErrorCode::kResourceExhausted);
  EXPECT_EQ(refused(good, limits).field, "guides");

  parts = good;
  parts.display_name.assign(201, 'x');
  EXPECT_EQ(refused(parts, {}).field, "header.display_name");

  parts = good;
  std::get<Ellipsoid>(parts.scalp).radii.y() = -1;
  EXPECT_EQ(refused(parts, {}).field, "header.ellipsoid.radii_m.y");
}

}  // namespace
}  // namespace mane::groom
