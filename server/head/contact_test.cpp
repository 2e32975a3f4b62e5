// A head's hair among bodies, as heads step it:
//   depth    no point of any hair is deeper than 1 mm in a head that stands, in gusts of wind, nor
//            deeper than 3 mm in one that walks or in the shoulders that walk with it
//   swing    nor in arms that swing past a chest
//   rest     hair that lies on a head lies still, in steps of any size
//   reset    hair lies where it did at first, and goes on the same way
//   bits     are the same for any number of workers, and from a copy of the state
//   freedom  bodies out of reach change nothing

#include "head/contact.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "contact/shape.h"
#include "head/frame.h"
#include "head/head.h"
#include "head/sample_groom.h"
#include "rod/test_strands.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;

constexpr int kPoints = 31;

// Hair of a type on a scalp that it meets.
std::shared_ptr<const groom::Groom> Hair(groom::HairType type, double length, int guides) {
  auto groom = std::make_shared<groom::Groom>(*GeneratedGroom(type, guides, length, 0));
  groom->scalp_friction = groom::Friction{};
  return groom;
}

// Points of all guides at equal arc length in the world, (guides x kPoints).
std::vector<Vector3d> Points(const groom::Groom& groom, const HeadState& state,
                             exec::WorkerPool& pool) {
  const std::string bytes =
      EncodeFrame(groom, state, {FrameFormat::kPositionsFloat32, Space::kWorld, kPoints}, pool);
  std::vector<Vector3d> points(static_cast<size_t>(groom.guide_count()) * kPoints);
  EXPECT_EQ(bytes.size(), points.size() * 12);
  for (size_t i = 0; i < points.size(); ++i) {
    float p[3];
    std::memcpy(p, &bytes[12 * i], 12);
    points[i] = Vector3d(p[0], p[1], p[2]);
  }
  return points;
}

// How deep the deepest point beyond `root` [m] of its strand lies in a body at `pose`.
double Deepest(const groom::Groom& groom, const std::vector<Vector3d>& points,
               const contact::BodyShape& shape, const math::Pose& pose, double root) {
  double deepest = -1e9;
  for (int g = 0; g < groom.guide_count(); ++g) {
    for (int k = 0; k < kPoints; ++k) {
      if (k * groom.guides[g].strand.TotalLength() / (kPoints - 1) < root) continue;
      const Vector3d p = pose.Inverse() * points[g * kPoints + k];
      deepest = std::max(deepest, -contact::At(shape, p).distance);
    }
  }
  return deepest;
}

constexpr double kRoot = 0.006;  // Hair leaves the skin up to here [m].

struct Sort {
  groom::HairType type;
  double length;
};
constexpr Sort kSorts[] = {
    {groom::HairType::kAsianSmooth, 0.12},   {groom::HairType::kAsianSmooth, 0.3},
    {groom::HairType::kCaucasianWavy, 0.12}, {groom::HairType::kCaucasianWavy, 0.3},
    {groom::HairType::kCaucasianCurly, 0.2}, {groom::HairType::kAfricanFuzzy, 0.2}};

std::string NameOf(const Sort& sort) {
  return fmt::format("type {} of {} m", static_cast<int>(sort.type), sort.length);
}

class ContactTest : public testing::Test {
 protected:
  std::shared_ptr<const Bodies> BodiesOf(const groom::Groom& groom) {
    return *MakeBodies(groom, &fields_, pool_);
  }
  exec::WorkerPool pool_{2};
  contact::FieldCache fields_{{}, size_t{1} << 30, 2};
};

TEST_F(ContactTest, NoHairEntersAStandingHead) {
  for (const Sort& sort : kSorts) {
    SCOPED_TRACE(NameOf(sort));
    const auto groom = Hair(sort.type, sort.length, 60);
    const auto bodies = BodiesOf(*groom);
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, bodies, &state);
    Environment air;
    air.wind = {1, 0, 0.5};
    air.wind_variation = {.gust_strength = 0.5, .gust_period = 2, .turbulence_speed = 0.5};
    double deepest = -1;
    for (int i = 0; i < 20 * 60; ++i) {
      const StepReport report = Advance(*groom, {{}, 1 / 60.0, 1}, air, &state, pool_);
      ASSERT_EQ(report.repaired_guides, 0);
      deepest = std::max(deepest, Deepest(*groom, Points(*groom, state, pool_),
                                          bodies->bodies[0].shape, bodies->bodies[0].pose, kRoot));
    }
    EXPECT_LT(deepest, 1e-3);
    EXPECT_GT(deepest, -3e-3);  // Some of it lies there.
  }
}

// How far somebody has come who sets out at t = 0 and walks at 1.4 m/s a second later.
double Way(double t) { return 1.4 * (t < 1 ? 0.5 * t * t : t - 0.5); }
// His head, which looks about, and his shoulders.
math::Pose WalkingHead(double t) {
  const double phase = 2 * M_PI * 1.9 * t;
  return {{0.015 * std::sin(phase / 2), 0.02 * std::sin(phase), Way(t)},
          math::FromRotationVector({0.03 * std::sin(phase), 0.3 * std::sin(1.3 * t), 0})};
}
math::Pose WalkingShoulders(double t) {
  const double phase = 2 * M_PI * 1.9 * t;
  return {{0, -0.13 + 0.02 * std::sin(phase), Way(t)},
          math::FromRotationVector({0, 0.15 * std::sin(phase / 2), 0})};
}

TEST_F(ContactTest, HairIsNowhereDeepInABodyThatWalks) {
  double nearest = -1;
  for (const Sort& sort : kSorts) {
    SCOPED_TRACE(NameOf(sort));
    auto groom = std::make_shared<groom::Groom>(*Hair(sort.type, sort.length, 60));
    groom::Body shoulders;
    shoulders.name = "shoulders";
    shoulders.shape = groom::Body::Capsule{{-0.15, 0, 0}, {0.15, 0, 0}, 0.06};
    shoulders.moving = true;
    shoulders.pose = WalkingShoulders(0);
    groom->bodies.push_back(shoulders);
    const auto bodies = BodiesOf(*groom);
    HeadState state = AtRest(*groom, WalkingHead(0));
    StartContact(*groom, bodies, &state);
    double in_head = -1, in_shoulders = -1;
    for (int i = 1; i <= 20 * 60; ++i) {
      const math::Pose head = WalkingHead(i / 60.0), body = WalkingShoulders(i / 60.0);
      const StepReport report = Advance(*groom, {head, 1 / 60.0, 1, {&body, 1}}, {}, &state, pool_);
      ASSERT_EQ(report.repaired_guides, 0);
      const std::vector<Vector3d> points = Points(*groom, state, pool_);
      in_head = std::max(in_head, Deepest(*groom, points, bodies->bodies[0].shape,
                                          head * bodies->bodies[0].pose, kRoot));
      in_shoulders =
          std::max(in_shoulders, Deepest(*groom, points, bodies->bodies[1].shape, body, kRoot));
    }
    EXPECT_LT(in_head, 3e-3);
    EXPECT_LT(in_shoulders, 3e-3);
    nearest = std::max(nearest, in_shoulders);
  }
  EXPECT_GT(nearest, -3e-3);  // Some of it lies on them.
}

groom::Body Limb(const std::string& name, const Vector3d& from, const Vector3d& to, double radius) {
  groom::Body limb;
  limb.name = name;
  limb.shape = groom::Body::Capsule{from, to, radius};
  return limb;
}
// A chest, and arms that hang from its shoulders, so far from the middle [m].
std::vector<groom::Body> ChestAndArms(double apart) {
  groom::Body chest;
  chest.name = "chest";
  chest.shape = groom::Body::Ellipsoid{{0.16, 0.25, 0.09}};
  chest.pose.p = {0, -0.37, 0};
  std::vector<groom::Body> bodies = {chest};
  for (const double side : {-1, 1}) {
    bodies.push_back(Limb(side < 0 ? "right" : "left", {0, 0, 0}, {0, -0.3, 0}, 0.045));
    bodies.back().pose.p = {side * apart, -0.17, 0};
  }
  return bodies;
}

// Long hair lies on the arms of somebody who walks; they take it along, and draw it over chest and
// shoulders.
TEST_F(ContactTest, ArmsThatSwingPastAChestDoNotEnterHair) {
  auto groom = std::make_shared<groom::Groom>(*Hair(groom::HairType::kAsianSmooth, 0.55, 100));
  groom->bodies = ChestAndArms(0.23);
  for (groom::Body& body : groom->bodies) body.moving = true;
  const auto bodies = BodiesOf(*groom);
  HeadState state = AtRest(*groom, WalkingHead(0));
  StartContact(*groom, bodies, &state);
  double deepest = -1;
  for (int i = 1; i <= 20 * 60; ++i) {
    const double t = i / 60.0, swing = 0.6 * std::min(1.0, t) * std::sin(2 * M_PI * 0.95 * t);
    const math::Pose head = WalkingHead(t);
    math::Pose chest = WalkingShoulders(t);
    chest.p.y() += 0.13;
    std::vector<math::Pose> poses;
    for (const groom::Body& body : groom->bodies) poses.push_back(chest * body.pose);
    poses[1].q = poses[1].q * math::FromRotationVector({swing, 0, 0});
    poses[2].q = poses[2].q * math::FromRotationVector({-swing, 0, 0});
    const StepReport report = Advance(*groom, {head, 1 / 60.0, 1, poses}, {}, &state, pool_);
    ASSERT_EQ(report.repaired_guides, 0);
    const std::vector<Vector3d> points = Points(*groom, state, pool_);
    for (size_t b = 0; b < bodies->bodies.size(); ++b) {
      const math::Pose pose = b == 0 ? head * bodies->bodies[0].pose : poses[b - 1];
      deepest = std::max(deepest, Deepest(*groom, points, bodies->bodies[b].shape, pose, kRoot));
    }
  }
  EXPECT_LT(deepest, 3e-3);
  EXPECT_GT(deepest, -3e-3);
}

// Somebody shakes his head, or its tracker trembles.
TEST_F(ContactTest, ShakingAndTremblingHeadsKeepTheirHairOutside) {
  for (const double length : {0.15, 0.3}) {
    for (const bool trembles : {false, true}) {
      SCOPED_TRACE(fmt::format("{} m, trembles {}", length, trembles));
      const auto groom = Hair(groom::HairType::kAsianSmooth, length, 64);
      const auto bodies = BodiesOf(*groom);
      HeadState state = AtRest(*groom, {});
      StartContact(*groom, bodies, &state);
      rod::fixtures::Random random(5);
      double deepest = -1;
      for (int i = 1; i <= 6 * 60; ++i) {
        const double t = i / 60.0;
        math::Pose head;
        head.p.x() = 0.03 * std::min(1.0, t) * std::sin(2 * M_PI * 2 * t);
        if (trembles) head.p = random.Vector(0.003);
        ASSERT_EQ(Advance(*groom, {head, 1 / 60.0, 1}, {}, &state, pool_).repaired_guides, 0);
        deepest =
            std::max(deepest, Deepest(*groom, Points(*groom, state, pool_), bodies->bodies[0].shape,
                                      head * bodies->bodies[0].pose, kRoot));
      }
      EXPECT_LT(deepest, trembles ? 1e-2 : 1e-3);  // By 0.4 m/s to and fro, 60 times a second.
    }
  }
}

// Hair that nothing moves does not start by itself, whatever the steps.
TEST_F(ContactTest, HairAtRestStaysAtRestInStepsOfAnySize) {
  const auto groom = Hair(groom::HairType::kAsianSmooth, 0.45, 60);
  const auto bodies = BodiesOf(*groom);
  for (const int substeps : {1, 2, 4, 16}) {
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, bodies, &state);
    std::vector<Vector3d> before = Points(*groom, state, pool_);
    double fastest = 0;
    for (int i = 0; i < 4 * 60; ++i) {
      Advance(*groom, {{}, 1 / 60.0, substeps}, {}, &state, pool_);
      const std::vector<Vector3d> now = Points(*groom, state, pool_);
      for (size_t k = 0; k < now.size(); ++k) {
        fastest = std::max(fastest, 60 * (now[k] - before[k]).norm());
      }
      before = now;
    }
    EXPECT_LT(fastest, 1e-3) << substeps;
  }
}

TEST_F(ContactTest, ResetLeadsBackToTheStart) {
  const auto groom = Hair(groom::HairType::kCaucasianWavy, 0.2, 40);
  HeadState state = AtRest(*groom, {});
  StartContact(*groom, BodiesOf(*groom), &state);
  const HeadState start = state;
  for (int i = 1; i <= 60; ++i) {
    Advance(*groom, {WalkingHead(i / 60.0), 1 / 60.0, 1}, {}, &state, pool_);
  }
  EXPECT_NE(Coordinates(*groom, state), Coordinates(*groom, start));
  Reset(*groom, &state);
  state.pose = {};
  HeadState again = start;
  for (int i = 0; i < 30; ++i) {
    Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool_);
    Advance(*groom, {{}, 1 / 60.0, 1}, {}, &again, pool_);
  }
  EXPECT_EQ(Coordinates(*groom, state), Coordinates(*groom, again));
}

TEST_F(ContactTest, HairThatLiesOnAHeadLiesStill) {
  for (const Sort& sort : kSorts) {
    SCOPED_TRACE(NameOf(sort));
    const auto groom = Hair(sort.type, sort.length, 60);
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, BodiesOf(*groom), &state);
    for (int i = 0; i < 5 * 60; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool_);
    std::vector<Vector3d> before = Points(*groom, state, pool_);
    double fastest = 0;
    for (int i = 0; i < 5 * 60; ++i) {
      Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool_);
      const std::vector<Vector3d> now = Points(*groom, state, pool_);
      for (int g = 0; g < groom->guide_count(); ++g) {
        const int tip = g * kPoints + kPoints - 1;
        fastest = std::max(fastest, 60 * (now[tip] - before[tip]).norm());
      }
      before = now;
    }
    EXPECT_LT(fastest, 1e-3);
  }
}

TEST_F(ContactTest, BitsDoNotDependOnWorkers) {
  const auto groom = Hair(groom::HairType::kCaucasianWavy, 0.2, 60);
  const auto bodies = BodiesOf(*groom);
  const auto run = [&](int workers) {
    exec::WorkerPool pool(workers);
    HeadState state = AtRest(*groom, {});
    StartContact(*groom, bodies, &state);
    for (int i = 1; i <= 60; ++i) {
      Advance(*groom, {WalkingHead(i / 60.0), 1 / 60.0, 1}, {}, &state, pool);
      if (i == 30) state = HeadState(state);  // A checkpoint.
    }
    return Coordinates(*groom, state);
  };
  const std::vector<double> one = run(1);
  EXPECT_EQ(run(2), one);
  EXPECT_EQ(run(5), one);
  // Fields and rest among bodies, too.
  exec::WorkerPool single(1);
  contact::FieldCache fresh({}, size_t{1} << 30, 1);
  const auto again = *MakeBodies(*groom, &fresh, single);
  for (size_t row = 0; row < again->settled.size(); ++row) {
    EXPECT_EQ(std::memcmp(&again->settled[row], &bodies->settled[row], sizeof(again->settled[row])),
              0);
  }
}

TEST_F(ContactTest, ABodyOutOfReachChangesNothingButRounding) {
  auto groom = std::make_shared<groom::Groom>(*Hair(groom::HairType::kCaucasianWavy, 0.2, 30));
  groom->scalp_friction.reset();
  groom::Body far;
  far.name = "far";
  far.shape = groom::Body::Ellipsoid{{0.1, 0.1, 0.1}};
  far.pose.p = {0, 5, 0};
  groom->bodies.push_back(far);
  HeadState with = AtRest(*groom, {}), without = with;
  StartContact(*groom, BodiesOf(*groom), &with);
  with.guides = without.guides;
  for (int i = 1; i <= 30; ++i) {
    const Movement movement{WalkingHead(i / 60.0), 1 / 60.0, 1};
    Advance(*groom, movement, {}, &with, pool_);
    Advance(*groom, movement, {}, &without, pool_);
  }
  const std::vector<Vector3d> a = Points(*groom, with, pool_), b = Points(*groom, without, pool_);
  for (size_t i = 0; i < a.size(); ++i) EXPECT_LT((a[i] - b[i]).norm(), 1e-4);
}

}  // namespace
}  // namespace mane::head
