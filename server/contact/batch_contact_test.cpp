// Laws of batched strands among bodies, on every instruction set:
//   incline     hair that lies across a slope stays below the angle of friction and slides above it
//   held        what is held does not creep; what lets go is still rubbed with what friction takes
//   planes      a body that goes on under hair without changing its place does not shake it
//   groove      hair that several bodies touch lies still
//   scales      friction over pressure follows the cosine law wherever hair slides
//   energy      a body that does not move gives hair no energy, at any step
//   depth       hair that begins inside a body comes out no faster than it may, and stays out
//   folds       hair between whose points a body is thin or has an edge goes around it
//   far         what is far off is looked at before it is near
//   bounded     whatever moves, the state stays finite
//   neighbours  a lane's bits do not depend on what others meet
//   economy     a warm step does not allocate

#include "contact/batch_contact.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "base/test_allocations.h"
#include "contact/test_meshes.h"
#include "rod/chain.h"
#include "rod/energy.h"
#include "rod/test_batches.h"

namespace mane::contact {
namespace {

using Eigen::Vector3d;
using rod::Row;
using rod::fixtures::Random;
using rod::fixtures::State;
using rod::layout::kLanes;

constexpr double kDt = 1.0 / 60;

// Strands of equal N on a head, stepped among bodies that have a motion of their own.
class Among {
 public:
  Among(simd::Isa isa, BodyShape shape, const Friction& friction)
      : step_(rod::KernelsFor<float>(isa)), meetings_(MeetingKernelsFor(isa)) {
    AddBody(std::move(shape), {}, friction);
  }

  // One more, which moves on its own.
  void AddBody(BodyShape shape, const math::Pose& pose, const Friction& friction) {
    BodyGroup& group = groups_.emplace_back();
    group.bodies.push_back({std::move(shape), {pose, pose}});
    group.frictions.push_back(friction);
  }

  void Add(const rod::Strand& strand, const math::Pose& root, const State& state) {
    strands_.push_back(std::make_unique<rod::Strand>(strand));
    roots_.push_back(root);
    starts_.push_back(state);
  }
  void Pack() {
    std::vector<rod::RootedStrand> rooted;
    for (size_t i = 0; i < strands_.size(); ++i) rooted.push_back({strands_[i].get(), roots_[i]});
    batch_ = rod::Batch<float>(rooted);
    state_.resize(batch_.state_rows());
    for (size_t i = 0; i < strands_.size(); ++i) {
      batch_.SetStrand(static_cast<int>(i), starts_[i].View(), state_);
    }
    ASSERT_EQ(batch_.blocks().size(), 1U);
    first_point_ = FirstPoints(batch_, block());
    for (const BodyGroup& group : groups_) group_list_.push_back(&group);
    motions_.resize(groups_.size());
    memory_.resize(MemoryRows(points(), groups_.size()));
    Forget(memory_);
  }
  [[nodiscard]] uint32_t Step(const rod::ClampMotion& head, const rod::Surroundings& air,
                              const BodyMotion& body) {
    rod::SetDrive<float>(head, air, 0, kLanes, drive_);
    motions_.assign(groups_.size(), MotionOf(body, head));
    const BatchContact contact{step_, meetings_, group_list_, motions_, settings};
    return StepBlockAmong(contact, batch_, block(), first_point_, drive_, memory_, state_, scratch);
  }
  [[nodiscard]] State Get(int i) const {
    State state = starts_[i];
    batch_.GetStrand(i, state_, state.View());
    return state;
  }
  [[nodiscard]] Vector3d Tip(int i) const {
    return rod::fixtures::Tip(*strands_[i], roots_[i], Get(i).theta);
  }
  // How deep the centreline beyond `root` [m] of its length lies in a shape at rest, on a head at
  // `head` [m].
  [[nodiscard]] double Deepest(int i, const BodyShape& shape, double root,
                               const math::Pose& head = {}) const {
    const State state = Get(i);
    double deepest = -1;
    for (double s = root; s < strands_[i]->TotalLength(); s += 1e-3) {
      const Vector3d p =
          rod::PointAt(*strands_[i], head * roots_[i], state.theta, rod::Locate(*strands_[i], s)).r;
      deepest = std::max(deepest, -At(shape, p).distance);
    }
    return deepest;
  }
  // How a point of the first lane met a body in the last solution of a step, in the kernel's units.
  struct Meeting {
    double rub, mass, hold;
    Vector3d velocity, normal, tangent;
    double pressing;    // Normal impulse,
    Vector3d friction;  // and across.
  };
  [[nodiscard]] Meeting MeetingOf(int point) const {
    const auto number = [](const std::vector<Row<float>>& rows, int row) {
      return double{rows[row].lane[0]};
    };
    const auto vector = [&](const std::vector<Row<float>>& rows, int row) {
      return Vector3d(number(rows, row), number(rows, row + 1), number(rows, row + 2));
    };
    const int load = point * rod::layout::kLoadRows, meeting = point * kMeetingRows;
    const double hold = number(scratch.loads, load + rod::layout::kHold);
    const Vector3d u = vector(scratch.velocities, 3 * point),
                   n = vector(scratch.loads, load + rod::layout::kNormal),
                   push = vector(scratch.loads, load + rod::layout::kPush);
    const Vector3d t =
        vector(scratch.points, point * rod::layout::kPointRows + rod::layout::kTangent);
    const double press = number(scratch.loads, load + rod::layout::kPress);
    const Vector3d rubs = push - hold * u;
    return {number(scratch.meetings, meeting + kRub),
            number(scratch.meetings, meeting + kMass),
            hold,
            u,
            n,
            t,
            n.dot(push) - press * n.dot(u),
            rubs - n * n.dot(rubs)};
  }
  [[nodiscard]] const rod::Batch<float>::Block& block() const { return batch_.blocks()[0]; }
  [[nodiscard]] int points() const { return first_point_.back(); }
  [[nodiscard]] const std::vector<Row<float>>& state() const { return state_; }

  BatchContactSettings settings;
  BatchContactScratch scratch;

 private:
  const rod::KernelTable<float>& step_;
  const MeetingKernels& meetings_;
  std::vector<BodyGroup> groups_;
  std::vector<const BodyGroup*> group_list_;
  std::vector<GroupMotion> motions_;
  std::vector<std::unique_ptr<rod::Strand>> strands_;
  std::vector<math::Pose> roots_;
  std::vector<State> starts_;
  rod::Batch<float> batch_;
  std::vector<Row<float>> state_, memory_;
  std::array<Row<float>, rod::layout::kDriveRows> drive_;
  std::vector<int> first_point_;
};

// A table whose top is y = 0.
BodyShape Table() {
  static const std::shared_ptr<const MeshField> field = [] {
    exec::WorkerPool pool(2);
    return *MeshField::Build(fixtures::Box({-0.15, -0.06, -0.3}, {0.35, 0, 0.3}), {}, &pool);
  }();
  return field;
}

// Soft straight hair along x on the table, from its root on.
struct Lying {
  rod::Strand strand;
  math::Pose root{{0, 5e-4, 0}, Eigen::Quaterniond::Identity()};

  explicit Lying(int N) : strand(rod::fixtures::HeavyStrand(2e4, N)) {
    strand.air_drag = 2 * strand.linear_density;  // Settles within some seconds.
  }
};

// How far the tip moves between two times [s] on a slope of `angle` across the hair, which it
// begins on at rest.
double Slide(simd::Isa isa, double mu, double angle, double from, double to) {
  const Lying lying(8);
  Among hair(isa, Table(), {mu, 0});
  hair.Add(lying.strand, lying.root, State(lying.strand));
  hair.Pack();
  rod::Surroundings air;
  air.gravity = 9.81 * Vector3d(0, -std::cos(angle), std::sin(angle));
  Vector3d start = Vector3d::Zero();
  for (int i = 0; i < to / kDt; ++i) {
    if (i == std::lround(from / kDt)) start = hair.Tip(0);
    EXPECT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
  }
  return (hair.Tip(0) - start).norm();
}

TEST(BatchContactTest, HairOnASlopeSlidesAboveTheAngleOfFriction) {
  for (const simd::Isa isa : simd::Supported()) {
    for (const double mu : {0.1, 0.3, 0.6, 1.0}) {
      double holds = 0.5 * std::atan(mu), slides = std::min(1.5, 1.5 * std::atan(mu));
      for (int i = 0; i < 7; ++i) {
        const double angle = 0.5 * (holds + slides);
        (Slide(isa, mu, angle, 0.5, 2.5) < 1e-3 ? holds : slides) = angle;
      }
      EXPECT_NEAR(0.5 * (holds + slides) / std::atan(mu), 1, 0.05) << mu << " " << simd::Name(isa);
    }
  }
}

// Two tables that lean towards each other, with curled hair in the groove between them: each pushes
// it onto the other.
TEST(BatchContactTest, HairBetweenTwoBodiesLiesStill) {
  for (const simd::Isa isa : simd::Supported()) {
    for (const double lean : {0.4, 0.7, 1.0}) {
      Lying lying(8);
      for (int Q = 0; Q < 8; ++Q) {
        lying.strand.natural[Q] = Vector3d(0, (Q % 2 == 0 ? 40 : -40), 25);
      }
      const auto table = [&](double side) {
        return math::Pose{{0, 0, 0}, math::FromRotationVector(Vector3d(side * lean, 0, 0))};
      };
      Among hair(isa, Table(), {0.1, 0});
      hair.AddBody(Table(), table(1), {0.1, 0});
      hair.AddBody(Table(), table(-1), {0.1, 0});
      hair.Add(lying.strand, lying.root, State(lying.strand));
      hair.Pack();
      for (int i = 0; i < 5 / kDt; ++i) EXPECT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
      double fastest = 0;
      for (int i = 0; i < 1 / kDt; ++i) {
        const Vector3d before = hair.Tip(0);
        EXPECT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
        fastest = std::max(fastest, (hair.Tip(0) - before).norm() / kDt);
      }
      EXPECT_LT(fastest, 1e-4) << lean << " " << simd::Name(isa);
    }
  }
}

TEST(BatchContactTest, WhatIsHeldDoesNotCreep) {
  for (const simd::Isa isa : simd::Supported()) {
    EXPECT_LT(Slide(isa, 0.6, 0.7 * std::atan(0.6), 3, 13), 2e-6) << simd::Name(isa);
  }
}

// A slope that tilts ever more across curled hair: point after point reaches its limit. What lets
// go must not leave to others what friction still takes of it, or they let go, too.
TEST(BatchContactTest, WhatLetsGoIsStillRubbedInFull) {
  for (const simd::Isa isa : simd::Supported()) {
    constexpr double kMu = 0.4;
    Lying lying(8);
    for (int Q = 0; Q < 8; ++Q) {
      lying.strand.natural[Q] = Vector3d(0, (Q % 2 == 0 ? 40 : -40), 25);
    }
    Among hair(isa, Table(), {kMu, 0});
    hair.Add(lying.strand, lying.root, State(lying.strand));
    hair.Pack();
    std::vector<bool> held(hair.points(), false);
    int let_go = 0;
    double least = 1;
    for (int step = 0; step < 20 / kDt; ++step) {
      const double angle = std::max(0.0, 0.02 * (step * kDt - 5));
      rod::Surroundings air;
      air.gravity = 9.81 * Vector3d(0, -std::cos(angle), std::sin(angle));
      ASSERT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
      for (int i = 0; i < hair.points(); ++i) {
        const Among::Meeting meeting = hair.MeetingOf(i);
        if (meeting.rub < -0.5 && held[i] && step > 5 / kDt &&
            meeting.pressing > 0.5 * 9.81 * kDt * meeting.mass) {
          ++let_go;
          least = std::min(least, meeting.friction.norm() / (kMu * meeting.pressing));
        }
        held[i] = meeting.rub > 0.5;
      }
    }
    EXPECT_GT(let_go, 3) << simd::Name(isa);
    EXPECT_GT(least, 0.3) << simd::Name(isa);
  }
}

// Hair over a ball that turns about its centre, without friction: its place stays what it is.
TEST(BatchContactTest, ABallThatTurnsSlowlyDoesNotShakeTheHairOnIt) {
  for (const simd::Isa isa : simd::Supported()) {
    Among hair(isa, Ellipsoid({0.05, 0.05, 0.05}), {0, 0});
    rod::Strand strand = rod::fixtures::HeavyStrand(300, 8);
    strand.air_drag = 10 * strand.linear_density;
    hair.Add(strand, {{0, 0.0505, 0}, Eigen::Quaterniond::Identity()}, State(strand));
    hair.Pack();
    const auto ball = [](int step) {
      return math::Pose{{0, 0, 0}, math::FromRotationVector({0, 0.05 * step * kDt, 0})};
    };
    double fastest = 0;
    for (int step = 0; step < 16 / kDt; ++step) {
      const Vector3d before = hair.Tip(0);
      ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {ball(step), ball(step + 1), kDt}), 0U);
      if (step > 10 / kDt) fastest = std::max(fastest, (hair.Tip(0) - before).norm() / kDt);
    }
    EXPECT_LT(fastest, 2e-4) << simd::Name(isa);
  }
}

// The table is drawn away under hair that lies on it, in any direction.
TEST(BatchContactTest, FrictionFollowsTheCosineLawInEveryDirection) {
  for (const simd::Isa isa : simd::Supported()) {
    for (int turn = 0; turn < 8; ++turn) {
      const double angle = turn * M_PI / 4;
      const Friction friction{0.3, 0.5};
      const Lying lying(8);
      Among hair(isa, Table(), friction);
      hair.Add(lying.strand, lying.root, State(lying.strand));
      hair.Pack();
      const Vector3d speed = 0.05 * Vector3d(std::cos(angle), 0, std::sin(angle));
      double friction_impulse = 0, expected = 0;
      for (int step = 0; step < 140; ++step) {
        const auto at = [&](int k) {
          return math::Pose{k * kDt * speed, Eigen::Quaterniond::Identity()};
        };
        ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {at(step), at(step + 1), kDt}), 0U);
        if (step < 80) continue;  // Until it lies along and slides.
        for (int i = 0; i < hair.points(); ++i) {
          const Among::Meeting meeting = hair.MeetingOf(i);
          // What hardly slides any more is held (K3).
          if (meeting.rub > -0.5 || meeting.hold > 900 * meeting.mass) continue;
          const Vector3d over = meeting.velocity - speed,
                         slip = over - meeting.normal * meeting.normal.dot(over);
          friction_impulse += meeting.hold * slip.norm();
          expected += friction.Coefficient(slip, meeting.tangent) * meeting.pressing;
        }
      }
      EXPECT_GT(expected, 1);
      const double share = friction_impulse / expected;
      // Drawn to its root, hair buckles and hops: friction is then a step behind, and less.
      EXPECT_GT(share, std::cos(angle) > -0.1 ? 0.97 : 0.5) << angle << " " << simd::Name(isa);
      EXPECT_LT(share, 1.03) << angle << " " << simd::Name(isa);
    }
  }
}

TEST(BatchContactTest, ABodyAtRestGivesNoEnergy) {
  for (const simd::Isa isa : simd::Supported()) {
    Random random(41);
    rod::Surroundings air;
    air.gravity.setZero();
    for (int i = 0; i < 12; ++i) {
      const double dt = std::pow(10, random.Uniform(-3, -1.3));
      Among hair(isa, Table(), {0.5, 0.25});
      hair.settings.recovery_speed = 0;  // What a body owes hair inside it is not at issue here.
      std::vector<rod::Strand> strands;
      for (int lane = 0; lane < kLanes; ++lane) {
        const rod::Strand strand = random.UnevenStrand(5, 0.12, 1);
        const math::Pose root{{0, 0.05, 0}, random.Rotation()};
        State state(strand);
        for (Vector3d& rate : state.rate) rate = random.Vector(20);
        rod::GaussVelocities(strand.length, root, Vector3d::Zero(), Vector3d::Zero(), state.theta,
                             state.rate, state.velocity);
        hair.Add(strand, root, state);
        strands.push_back(strand);
      }
      hair.Pack();
      std::vector<double> before(kLanes, 1e9), start(kLanes);
      for (int step = 0; step < 60; ++step) {
        for (int lane = 0; lane < kLanes; ++lane) {
          const State state = hair.Get(lane);
          const double now = rod::KineticEnergy(strands[lane], state.velocity) +
                             rod::ElasticEnergy(strands[lane], state.theta);
          if (step == 0) start[lane] = now;
          EXPECT_LE(now, before[lane] + 2e-3 * start[lane])
              << i << " dt=" << dt << " step " << step << " lane " << lane;
          before[lane] = now;
        }
        ASSERT_EQ(hair.Step({{}, {}, dt}, air, {}), 0U);
      }
    }
  }
}

TEST(BatchContactTest, HairThatBeginsInsideComesOutSmoothly) {
  for (const simd::Isa isa : simd::Supported()) {
    Among hair(isa, Table(), {0.3, 0.25});
    const rod::Strand strand = rod::fixtures::HeavyStrand(2000, 8);
    // From above the table down through it.
    const math::Pose root{
        {0, 0.01, 0},
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d(1, -0.2, 0).normalized())};
    hair.Add(strand, root, State(strand));
    hair.Pack();
    rod::Surroundings air;
    air.air_drag_scale = 1;
    double fastest = 0;
    Vector3d tip = hair.Tip(0);
    EXPECT_LT(tip.y(), -0.02);
    for (int i = 0; i < 5 / kDt; ++i) {
      ASSERT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
      fastest = std::max(fastest, (hair.Tip(0) - tip).y() / kDt);
      tip = hair.Tip(0);
    }
    EXPECT_LT(fastest, 1.2 * hair.settings.recovery_speed + 0.05);
    EXPECT_GT(tip.y(), 0);
    EXPECT_LT(tip.y(), 2e-3);
  }
}

BodyShape FieldOf(const TriangleMesh& mesh) {
  exec::WorkerPool pool(2);
  return *MeshField::Build(mesh, {}, &pool);
}

// A plate upright like an ear, and the edge of a table, which soft hair from above falls on: at any
// place between two of its points.
TEST(BatchContactTest, HairGoesAroundWhatIsThinnerThanItsPointsAreApart) {
  const BodyShape ear = FieldOf(fixtures::Box({-0.1, -0.1, -0.0025}, {0.1, 0, 0.0025}, 8)),
                  edge = FieldOf(fixtures::Box({-0.1, -0.1, -0.1}, {0.1, 0, 0.0025}, 8));
  for (const simd::Isa isa : simd::Supported()) {
    for (const BodyShape& shape : {ear, edge}) {
      for (int place = 0; place < 6; ++place) {
        Among hair(isa, shape, {0.3, 0});
        const rod::Strand strand = rod::fixtures::HeavyStrand(2e4, 4);
        // At first it leads through the plate, 2 mm below its rim.
        const math::Pose root{
            {0, 0.012, -0.06 - 0.0025 * place},
            Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d(0, -0.2, 0.9))};
        hair.Add(strand, root, State(strand));
        hair.Pack();
        rod::Surroundings air;
        air.air_drag_scale = 1;
        for (int i = 0; i < 4 / kDt; ++i) ASSERT_EQ(hair.Step({{}, {}, kDt}, air, {}), 0U);
        EXPECT_LT(hair.Deepest(0, shape, 0.02), 1e-3) << place << " " << simd::Name(isa);
        EXPECT_LT(hair.Tip(0).y(), -0.03);  // It hangs over.
        EXPECT_GT(hair.Tip(0).z(), 0);
      }
    }
  }
}

// Hair comes to a slanted plate from aside, where a field says that it is farther off than it is
// (D12).
TEST(BatchContactTest, WhatIsFarIsLookedAtBeforeItIsNear) {
  TriangleMesh plate = fixtures::Box({0, -0.01, -0.3}, {0.57, 0.01, 0.3}, 8);
  const Eigen::Quaternionf slant(
      Eigen::AngleAxisf(0.25F * static_cast<float>(M_PI), Eigen::Vector3f::UnitZ()));
  for (Eigen::Vector3f& vertex : plate.vertices) vertex = slant * vertex;
  const BodyShape shape = FieldOf(plate);
  const Vector3d from(0.46, -0.8, 0), to(0.06, 0.04, 0);
  EXPECT_GT(At(shape, from).distance, 1.05 * (from - to).norm());
  for (const simd::Isa isa : simd::Supported()) {
    Among hair(isa, shape, {0.3, 0});
    const rod::Strand strand = rod::fixtures::HeavyStrand(20, 6);
    const math::Pose root{from,
                          Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), Vector3d::UnitZ())};
    hair.Add(strand, root, State(strand));
    hair.Pack();
    rod::Surroundings air;
    air.gravity.setZero();
    air.air_drag_scale = 1;
    const auto head = [&](int i) {
      const double part = std::min(1.0, 0.5 * i * kDt / (to - from).norm());
      return math::Pose{part * (to - from), Eigen::Quaterniond::Identity()};
    };
    const int steps = static_cast<int>(std::ceil((to - from).norm() / (0.5 * kDt) + 0.5 / kDt));
    for (int i = 0; i < steps; ++i) ASSERT_EQ(hair.Step({head(i), head(i + 1), kDt}, air, {}), 0U);
    EXPECT_LT(hair.Deepest(0, shape, 0.1, head(steps)), 1e-3) << simd::Name(isa);
    EXPECT_GT(hair.Deepest(0, shape, 0.1, head(steps)), -1e-2);  // It has come there.
  }
}

TEST(BatchContactTest, IsBoundedAmongHostileBodies) {
  for (const simd::Isa isa : simd::Supported()) {
    Random random(42);
    for (int i = 0; i < 6; ++i) {
      Among hair(isa, Ellipsoid({0.1, 0.12, 0.11}), {0.8, 0.5});
      for (int lane = 0; lane < kLanes; ++lane) {
        const rod::Strand strand = random.UnevenStrand(5, 0.2, 2);
        hair.Add(strand, random.AnyRoot(), State(strand));
      }
      hair.Pack();
      math::Pose head = random.Pose(), ball = random.Pose();
      for (int step = 0; step < 60; ++step) {
        const math::Pose next{head.p + random.Vector(0.3), random.Rotation()},
            rolled{next.p + random.Vector(0.1), random.Rotation()};
        const double dt = random.Uniform(0.001, 1.0 / 60);
        ASSERT_EQ(hair.Step({head, next, dt}, {}, {ball, rolled, dt}), 0U) << i << " " << step;
        head = next, ball = rolled;
      }
    }
  }
}

TEST(BatchContactTest, LanesDoNotDependOnWhatOthersMeet) {
  for (const simd::Isa isa : simd::Supported()) {
    std::vector<std::vector<float>> results;
    for (const bool others : {false, true}) {
      Random random(9);
      Among hair(isa, Ellipsoid({0.08, 0.1, 0.09}), {0.4, 0.25});
      for (int lane = 0; lane < kLanes; ++lane) {
        const rod::Strand strand = random.UnevenStrand(5, 0.2, 1);
        const math::Pose near = random.AnyRoot();
        math::Pose root{{0.03, 0.08, 0.02}, Eigen::Quaterniond::Identity()};
        if (lane != 3) root = others ? near : math::Pose{{50, 0, 0}, near.q};
        hair.Add(strand, root, State(strand));
      }
      hair.Pack();
      const int lane =
          static_cast<int>(std::find(hair.block().strands.begin(), hair.block().strands.end(), 3) -
                           hair.block().strands.begin());
      std::vector<float> bits;
      for (int step = 0; step < 90; ++step) {
        ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
        for (const Row<float>& row : hair.state()) bits.push_back(row.lane[lane]);
      }
      results.push_back(bits);
    }
    EXPECT_EQ(results[0], results[1]) << simd::Name(isa);
  }
}

TEST(BatchContactTest, WarmStepsDoNotAllocate) {
  Among hair(simd::Best(), Table(), {0.3, 0.25});
  const Lying lying(8);
  for (int lane = 0; lane < kLanes; ++lane) {
    hair.Add(lying.strand, lying.root, State(lying.strand));
  }
  hair.Pack();
  ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
  const mane::fixtures::AllocationCount count;
  for (int i = 0; i < 20; ++i) ASSERT_EQ(hair.Step({{}, {}, kDt}, {}, {}), 0U);
  EXPECT_EQ(count.count(), 0);
}

}  // namespace
}  // namespace mane::contact
