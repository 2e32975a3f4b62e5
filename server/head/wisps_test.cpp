// Hair against hair, as heads step it:
//   rest     wisps that overlap at rest lie still
//   order    hair that a body drives into other hair pushes it along and does not pass through it
//   bits     are the same for any number of workers, from a copy of the state, and in whatever
//   order
//            guides of several numbers of elements come
//   finer    steps that hair does not expect are the finest, and only where wisps meet
//   bounded  shaken hair stays finite, and detail by tolerance leaves it alone

#include "head/wisps.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "groom/assemble.h"
#include "groom/validate.h"
#include "head/head.h"
#include "head/sample_groom.h"
#include "rod/chain.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

class WispsTest : public testing::Test {
 protected:
  std::shared_ptr<const Bodies> BodiesOf(const groom::Groom& groom) {
    return *MakeBodies(groom, &fields_, pool_);
  }
  exec::WorkerPool pool_{2};
  contact::FieldCache fields_{{}, size_t{1} << 30, 2};
};

// Guides of a type all over a head, each with the wisp around it that covers its share of scalp.
std::shared_ptr<const groom::Groom> Hair(groom::HairType type, int guides, double length) {
  auto groom = std::make_shared<groom::Groom>(*GeneratedGroom(type, guides, length, 0));
  for (groom::Guide& guide : groom->guides) guide.wisp_radius = 0.09 / std::sqrt(guides);
  groom->scalp_friction = groom::Friction{};
  return groom;
}

// Straight hair that hangs from the points `roots`, of so many elements in turn.
groom::Parts Hanging(const std::vector<Vector3d>& roots, double radius,
                     const std::vector<uint32_t>& elements = {8}) {
  groom::Parts parts;
  for (const Vector3d& root : roots) {
    groom::GuideDescription description;
    description.root_position = root;
    description.root_frame =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), -Vector3d::UnitY());
    description.length_m = 0.2;
    description.element_count = elements[parts.guides.size() % elements.size()];
    description.radius_1_m = 4e-5;
    description.radius_2_m = 4e-5;
    description.young_modulus_pa = 2e9;
    description.poisson_ratio = 0.48;
    description.density_kg_m3 = 1300;
    description.internal_friction = 1e-10;
    description.air_drag = 5e-6;
    description.wisp_radius_m = radius;
    parts.guides.push_back(*groom::MakeGuide(description, static_cast<int>(parts.guides.size())));
  }
  return parts;
}

// One that hair never meets: wisps meet in grooms with bodies only.
groom::Body FarBody() {
  groom::Body far;
  far.name = "far";
  far.shape = groom::Body::Capsule{{0, -5, 0}, {0, -5, 1}, 0.1};
  return far;
}

std::vector<Vector3d> Tips(const groom::Groom& groom, const HeadState& state) {
  const std::vector<double> all = Coordinates(groom, state);
  std::vector<Vector3d> tips;
  for (int i = 0; i < groom.guide_count(); ++i) {
    const groom::Guide& guide = groom.guides[i];
    std::vector<Vector3d> theta(guide.strand.elements());
    for (size_t Q = 0; Q < theta.size(); ++Q) {
      theta[Q] = Eigen::Map<const Vector3d>(&all[groom.first_coordinate[i] + 3 * Q]);
    }
    tips.push_back(rod::ElementFrames(guide.strand, state.pose * guide.root, theta).back().r);
  }
  return tips;
}

// Distance of the centrelines of the first two guides [m].
double Apart(const groom::Groom& groom, const HeadState& state) {
  constexpr int kPoints = 41;
  const std::vector<double> all = Coordinates(groom, state);
  std::vector<Vector3d> points[2];
  for (int i = 0; i < 2; ++i) {
    const groom::Guide& guide = groom.guides[i];
    const int N = guide.strand.elements();
    std::vector<Vector3d> theta(N);
    for (int Q = 0; Q < N; ++Q) {
      theta[Q] = Eigen::Map<const Vector3d>(&all[groom.first_coordinate[i] + 3 * Q]);
    }
    for (int k = 0; k < kPoints; ++k) {
      const double s = N * k / (kPoints - 1.0) * 0.999999;
      const int Q = static_cast<int>(s);
      points[i].push_back(rod::PointAt(guide.strand, state.pose * guide.root, theta, {Q, s - Q}).r);
    }
  }
  double least = 1;
  for (const Vector3d& a : points[0]) {
    for (const Vector3d& b : points[1]) least = std::min(least, (a - b).norm());
  }
  return least;
}

TEST_F(WispsTest, WispsThatOverlapAtRestLieStill) {
  const auto groom = Hair(groom::HairType::kAsianSmooth, 80, 0.15);
  const auto bodies = BodiesOf(*groom);
  ASSERT_TRUE(bodies->wisps);
  HeadState state = AtRest(*groom, {});
  StartContact(*groom, bodies, &state);
  const std::vector<Vector3d> start = Tips(*groom, state);
  for (int i = 0; i < 240; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool_);
  EXPECT_GT(state.contact.wisps.pairs().size(), 50U);
  std::vector<Vector3d> before = Tips(*groom, state);
  Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool_);
  const std::vector<Vector3d> end = Tips(*groom, state);
  double moved = 0, fastest = 0;
  for (size_t i = 0; i < end.size(); ++i) {
    moved = std::max(moved, (end[i] - start[i]).norm());
    fastest = std::max(fastest, 60 * (end[i] - before[i]).norm());
  }
  EXPECT_LT(moved, 5e-3);
  EXPECT_LT(fastest, 5e-3);
}

// A rod sweeps hair into other hair, slowly and at 4 m/s.
TEST_F(WispsTest, HairThatIsDrivenIntoOtherHairPushesItAlong) {
  for (const double speed : {0.2, 1.0, 4.0}) {
    for (const double radius : {0.0, 0.006}) {
      groom::Parts parts = Hanging({{-0.02, 0, 0}, {0.02, 0, 0}}, radius);
      groom::Body rod;
      rod.name = "rod";
      rod.shape = groom::Body::Capsule{{0, 0, -0.1}, {0, 0, 0.1}, 0.01};
      rod.moving = true;
      rod.pose.p = {-0.06, -0.12, 0};
      parts.bodies.push_back(rod);
      const auto groom = *groom::Assemble(std::move(parts), {}, nullptr);
      HeadState state = AtRest(*groom, {});
      StartContact(*groom, BodiesOf(*groom), &state);
      double least = 1, farthest = 0;
      math::Pose body = rod.pose;
      for (int i = 0; i < 90; ++i) {
        body.p.x() = std::min(0.02, body.p.x() + speed / 60);
        Advance(*groom, {{}, 1 / 60.0, 1, {&body, 1}}, {}, &state, pool_);
        const std::vector<Vector3d> tips = Tips(*groom, state);
        ASSERT_TRUE(tips[0].allFinite() && tips[1].allFinite());
        least = std::min(least, Apart(*groom, state));
        farthest = std::max(farthest, tips[1].x());
      }
      if (radius == 0) {
        EXPECT_LT(least, 0.5 * 0.006) << speed;  // Nothing keeps them apart.
      } else {
        EXPECT_GT(least, 0.35 * 2 * radius) << speed;  // Compressed, most at 4 m/s.
        EXPECT_GT(farthest, 0.03) << speed;
      }
    }
  }
}

TEST_F(WispsTest, BitsDoNotDependOnWorkers) {
  const auto groom = Hair(groom::HairType::kCaucasianWavy, 60, 0.15);
  const auto bodies = BodiesOf(*groom);
  const auto run = [&](int workers) {
    exec::WorkerPool pool(workers);
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, bodies, &state);
    Environment air;
    air.wind = {1, 0, 0};
    air.wind_variation.turbulence_speed = 0.5;
    for (int i = 1; i <= 40; ++i) {
      const math::Pose pose{{0.03 * std::sin(0.3 * i), 0, 0}, Eigen::Quaterniond::Identity()};
      EXPECT_EQ(Advance(*groom, {pose, 1 / 60.0, 1}, air, &state, pool).repaired_guides, 0);
      if (i == 20) state = HeadState(state);  // A checkpoint.
    }
    return Coordinates(*groom, state);
  };
  const std::vector<double> one = run(1);
  EXPECT_EQ(run(2), one);
  EXPECT_EQ(run(5), one);
}

TEST_F(WispsTest, BitsDoNotDependOnTheOrderOfGuides) {
  constexpr int kGuides = 36;  // Of each number of elements not a whole block.
  std::vector<Vector3d> roots;
  for (int i = 0; i < kGuides; ++i) roots.emplace_back(0.007 * (i % 6), 0, 0.008 * (i / 6));
  groom::Parts parts = Hanging(roots, 0.006, {3, 8, 20});
  parts.bodies.push_back(FarBody());
  groom::Parts reversed = parts;
  std::ranges::reverse(reversed.guides);
  double interplay = 0;
  const auto run = [&](groom::Parts of, bool wisps) {
    for (groom::Guide& guide : of.guides) guide.wisp_radius *= wisps;
    const auto groom = *groom::Assemble(std::move(of), {}, nullptr);
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, BodiesOf(*groom), &state);
    for (int i = 1; i <= 40; ++i) {
      const math::Pose pose{{0.03 * std::sin(0.3 * i), 0, 0.02 * std::sin(0.2 * i)},
                            Eigen::Quaterniond::Identity()};
      Advance(*groom, {pose, 1 / 60.0, 1}, {}, &state, pool_);
    }
    return Tips(*groom, state);
  };
  const std::vector<Vector3d> tips = run(parts, true), apart = run(parts, false);
  std::vector<Vector3d> back = run(reversed, true);
  std::ranges::reverse(back);
  EXPECT_EQ(tips, back);
  for (int i = 0; i < kGuides; ++i) interplay += (tips[i] - apart[i]).norm() / kGuides;
  EXPECT_GT(interplay, 1e-3);  // They do meet.
}

TEST_F(WispsTest, StepsThatHairDoesNotExpectAreTheFinest) {
  for (const double radius : {0.0, 0.006}) {
    groom::Parts parts = Hanging({{0, 0, 0}, {0.01, 0, 0}}, radius);
    parts.bodies.push_back(FarBody());
    const auto groom = *groom::Assemble(std::move(parts), {}, nullptr);
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, BodiesOf(*groom), &state);
    const auto fineness = [&](double way, int steps) {
      math::Pose end;
      end.p.x() = way;
      return FinenessFor(state.contact, {}, {{}, end, 1 / 60.0}, steps);
    };
    const int finest = radius > 0 ? kFinestOfWisps : kFinest;
    EXPECT_EQ(fineness(0.009, 1), 1);
    EXPECT_EQ(fineness(0.015, 1), 2);
    EXPECT_EQ(fineness(0.07, 1), finest);
    EXPECT_EQ(fineness(0.07, 4), 2);
    math::Pose pose;
    pose.p.x() = 0.07;
    Advance(*groom, {pose, 1 / 60.0, 1}, {}, &state, pool_);
    EXPECT_LE(state.contact.fineness, kFinest);  // By how it bent.
    pose.p.x() = 0.14;
    EXPECT_EQ(FinenessFor(state.contact, {}, {state.pose, pose, 1 / 60.0}, 1), 1);  // It goes on.
  }
}

TEST_F(WispsTest, ShakenHairStaysBoundedAtFullDetail) {
  const auto groom = Hair(groom::HairType::kCaucasianCurly, 60, 0.2);
  HeadState state = AtRest(*groom, {});
  StartContact(*groom, BodiesOf(*groom), &state);
  Environment air;
  air.detail_tolerance = 1;
  StartDetail(*groom, std::make_shared<Levels>(*groom, pool_), &state.detail);
  for (int i = 1; i <= 120; ++i) {
    const math::Pose pose{{0.08 * std::sin(0.5 * i), 0.05 * std::cos(0.3 * i), 0},
                          math::FromRotationVector({0, std::sin(0.2 * i), 0})};
    ASSERT_EQ(Advance(*groom, {pose, 1 / 60.0, 1}, air, &state, pool_).repaired_guides, 0);
  }
  EXPECT_EQ(SteppedElements(*groom, state), groom->element_count());
}

}  // namespace
}  // namespace mane::head
