// What moving segments obey, against closed forms and fine integration:
//   order         undivided recurrences follow a fine RK4 integration to the second order of dt,
//                 divided ones (B12) to the first, of B8 and of its form across the segment
//   energy        of an undamped pendulum stays within a band, without drift
//   frequency     of small swings is sqrt(lambda |F|), whatever the plane
//   axis          hair along Y turns toward the force in the plane of both
//   statics       held hair at rest stays; under a sideways acceleration it turns as a cantilever
//   modes         the tip of held hair swings as a cantilever beam, of hanging hair nearly as a
//                 chain
//   riding        friction makes held hair turn with the head; drag makes hair follow the wind
//   roots         accelerate as the head's pose says

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "beam/motion.h"
#include "beam/response.h"
#include "beam/test_motion.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::Angle;
using fixtures::Free;
using fixtures::Kernels;
using fixtures::Moving;
using fixtures::OwnHair;
using fixtures::Still;

// Fixed steps of RK4 of y' = f(y).
template <typename State>
State Rk4(State y, double time, int steps, const std::function<State(const State&)>& f) {
  const double h = time / steps;
  for (int i = 0; i < steps; ++i) {
    const State a = f(y), b = f(y + h / 2 * a), c = f(y + h / 2 * b), d = f(y + h * c);
    y += h / 6 * (a + 2 * b + 2 * c + d);
  }
  return y;
}

// A segment of lambda = 2 under F, from e with a rate.
struct Pendulum {
  Vector3d F{3, -9, 4};
  double lambda = 2;
  Vector3d e = Vector3d(0.4, 0.3, 0.8).normalized();
  Vector3d rate = Vector3d(-0.5, 2, 0.3);

  Pendulum() { rate -= rate.dot(e) * e; }

  // e'' = lambda F_t - |e'|^2 e.
  [[nodiscard]] Vector3d AcrossAfter(double time) const {
    using State = Eigen::Matrix<double, 6, 1>;
    State y;
    y << e, rate;
    y = Rk4<State>(y, time, 20'000, [this](const State& at) {
      const Vector3d n = at.head<3>(), v = at.tail<3>();
      State d;
      d << v, lambda * (F - F.dot(n) * n) - v.squaredNorm() * n;
      return d;
    });
    return y.head<3>();
  }
  // B8.
  [[nodiscard]] Vector3d PolarAfter(double time) const {
    const auto u = [](double t, double f) {
      return Vector3d(std::cos(t) * std::sin(f), -std::sin(t), std::cos(t) * std::cos(f));
    };
    const auto v = [](double f) { return Vector3d(std::cos(f), 0, -std::sin(f)); };
    const double t = std::acos(e.y()), f = std::atan2(e.x(), e.z());
    Eigen::Vector4d y(t, f, rate.dot(u(t, f)), rate.dot(v(f)) / std::sin(t));
    y = Rk4<Eigen::Vector4d>(y, time, 20'000, [&](const Eigen::Vector4d& at) {
      return Eigen::Vector4d(at[2], at[3], lambda * F.dot(u(at[0], at[1])),
                             lambda * std::sin(at[0]) * F.dot(v(at[1])));
    });
    return {std::sin(y[0]) * std::sin(y[1]), std::cos(y[0]), std::sin(y[0]) * std::cos(y[1])};
  }
  // The same by the batch; its rates are those half a step before.
  [[nodiscard]] Vector3d ByBatch(Equations equations, bool bounded, double time, int steps) const {
    const double dt = time / steps;
    MotionSettings settings;
    settings.equations = equations;
    settings.bounded = bounded;
    settings.clamped = false;
    Moving<double> moving({Free(1, e, lambda)}, settings);
    Vector3d begun = rate;
    if (equations == Equations::kAcross) begun -= dt / 2 * lambda * (F - F.dot(e) * e);
    if (equations == Equations::kPolar) {
      // In the angles: (t', sin t f') less half a step of B8.
      const double level = std::hypot(e.x(), e.z());
      const Vector3d v = Vector3d(e.z(), 0, -e.x()) / level, u = v.cross(e);
      begun -= dt / 2 * lambda * (F.dot(u) * u + level * level * F.dot(v) * v);
    }
    moving.Set(0, std::span(&e, 1), std::span(&begun, 1), dt);
    for (int i = 0; i < steps; ++i) moving.Step(Kernels(), Still(F, dt));
    return moving.Directions(0)[0];
  }
};

class OrderTest : public testing::TestWithParam<std::pair<Equations, bool>> {};
INSTANTIATE_TEST_SUITE_P(All, OrderTest,
                         testing::Values(std::pair(Equations::kAcross, false),
                                         std::pair(Equations::kAcross, true),
                                         std::pair(Equations::kPolar, false),
                                         std::pair(Equations::kPolar, true)));

TEST_P(OrderTest, FollowsAFineIntegration) {
  const auto [equations, bounded] = GetParam();
  const Pendulum pendulum;
  constexpr double kTime = 1;
  const Vector3d exact =
      equations == Equations::kAcross ? pendulum.AcrossAfter(kTime) : pendulum.PolarAfter(kTime);
  const double coarse = (pendulum.ByBatch(equations, bounded, kTime, 400) - exact).norm();
  const double fine = (pendulum.ByBatch(equations, bounded, kTime, 1600) - exact).norm();
  const double order = std::log(coarse / fine) / std::log(4);
  EXPECT_NEAR(order, 2, 0.1);
  EXPECT_LT(fine, 2e-5);
}

TEST(MotionLawTest, EnergyOfAnUndampedPendulumStays) {
  const Pendulum p;
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    MotionSettings settings;
    settings.equations = equations;
    settings.bounded = false;
    settings.clamped = false;
    const double dt = 0.02;
    // A force along the axis turns the plane of a polar pendulum not at all.
    const Vector3d F = equations == Equations::kPolar ? Vector3d(0, -10, 0) : p.F;
    Vector3d rate = p.rate;
    if (equations == Equations::kPolar) {
      rate = Vector3d::UnitY() - p.e.y() * p.e;
    }
    Moving<double> moving({Free(1, p.e, p.lambda)}, settings);
    moving.Set(0, std::span(&p.e, 1), std::span(&rate, 1), dt);
    // Least and greatest of a stretch of swings; rates are those halfway between two places.
    const auto band = [&](int steps) {
      double least = 1e30, greatest = -1e30;
      for (int i = 0; i < steps; ++i) {
        const Vector3d from = moving.Directions(0)[0];
        moving.Step(Kernels(), Still(F, dt));
        const double speed = moving.Steps(0)[0].norm() / dt;
        const double energy =
            speed * speed / 2 - p.lambda * F.dot(from + moving.Directions(0)[0]) / 2;
        least = std::min(least, energy), greatest = std::max(greatest, energy);
      }
      return std::pair(least, greatest);
    };
    const auto [first_least, first_greatest] = band(5'000);
    (void)band(200'000);
    const auto [last_least, last_greatest] = band(5'000);
    const double scale = p.lambda * F.norm();
    EXPECT_LT(first_greatest - first_least, 0.02 * scale);
    EXPECT_NEAR(last_least, first_least, 2e-3 * scale);
    EXPECT_NEAR(last_greatest, first_greatest, 2e-3 * scale);
  }
}

TEST(MotionLawTest, SmallSwingsHaveTheirFrequency) {
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    for (const Vector3d& across : {Vector3d(1, 0, 0), Vector3d(0, 1, 0)}) {
      MotionSettings settings;
      settings.equations = equations;
      settings.bounded = false;
      settings.clamped = false;
      const Vector3d F(0, 0, 9);
      const double lambda = 4, dt = 1e-3, expected = std::sqrt(lambda * F.norm());
      Moving<double> moving({Free(1, Vector3d::UnitZ() + 1e-3 * across, lambda)}, settings);
      // Times of passages through the middle.
      std::vector<double> passages;
      double before = 1e-3;
      for (int i = 1; passages.size() < 21; ++i) {
        moving.Step(Kernels(), Still(F, dt));
        const double at = moving.Directions(0)[0].dot(across);
        if (before * at < 0) passages.push_back((i - at / (at - before)) * dt);
        before = at;
      }
      const double omega = 20 * std::numbers::pi / (passages.back() - passages.front());
      EXPECT_NEAR(omega, expected, 1e-4 * expected);
    }
  }
}

// Undivided recurrences are stable just below dt^2 lambda |F| = 4, and not above; divided ones are.
TEST(MotionLawTest, RecurrencesAreStableBelowFour) {
  for (const bool bounded : {false, true}) {
    for (const double x : {3.9, 4.1}) {
      MotionSettings settings;
      settings.bounded = bounded;
      settings.clamped = false;
      settings.equations = Equations::kPolar;
      const Vector3d F(0, 0, 10);
      Moving<double> moving({Free(1, Vector3d(0, 1e-4, 1), x / F.norm())}, settings);
      double largest = 0;
      for (int i = 0; i < 200; ++i) {
        moving.Step(Kernels(), Still(F, 1));
        largest = std::max(largest, Angle(moving.Directions(0)[0], Vector3d::UnitZ()));
      }
      EXPECT_EQ(largest > 0.1, !bounded && x > 4) << bounded << " " << x;
    }
  }
}

TEST(MotionLawTest, HairAlongTheAxisTurnsTowardTheForce) {
  for (const double y : {1.0, -1.0}) {
    for (const double azimuth : {-2.5, -0.3, 0.0, 1.0, 3.0}) {
      MotionSettings settings;
      settings.equations = Equations::kPolar;
      settings.clamped = false;
      const Vector3d F = 10 * Vector3d(std::sin(azimuth), 0, std::cos(azimuth));
      Moving<double> moving({Free(1, {0, y, 0}, 2)}, settings);
      double nearer = 0;
      for (int i = 0; i < 20; ++i) {
        moving.Step(Kernels(), Still(F, 0.01));
        const Vector3d e = moving.Directions(0)[0];
        EXPECT_NEAR(e.dot(F.cross(Vector3d::UnitY())), 0, 1e-9);
        EXPECT_GT(e.dot(F), nearer);
        nearer = e.dot(F);
      }
      // As a segment across the axis does: 1/2 lambda |F| t^2.
      EXPECT_NEAR(nearer / F.norm(), std::sin(0.5 * 2 * 10 * 0.2 * 0.2), 0.04);
    }
  }
}

// The plane may turn while hair hangs along the axis: what of its step lies in the new one is kept.
TEST(MotionLawTest, ThePlaneFollowsAForceThatTurns) {
  MotionSettings settings;
  settings.equations = Equations::kPolar;
  settings.clamped = false;
  Moving<double> moving({Free(1, {0, -1, 0}, 2)}, settings);
  moving.Step(Kernels(), Still({2e-3, -10, 0}, 0.01));
  EXPECT_GT(moving.Directions(0)[0].x(), 0);
  const double begun = moving.Steps(0)[0].x();
  moving.Step(Kernels(), Still({-1e-2, -10, 0}, 0.01));
  EXPECT_LT(moving.Steps(0)[0].x(), begun);
  for (int i = 0; i < 10; ++i) moving.Step(Kernels(), Still({0, -10, 1}, 0.01));
  EXPECT_GT(moving.Directions(0)[0].z(), 1e-3);
}

// What direction hair has so near to the axis is kept when its plane is that of the force.
TEST(MotionLawTest, LeavingTheAxisKeepsTheDirection) {
  for (const double azimuth : {0.2, 1.0, 2.0, 3.0, -2.0}) {
    MotionSettings settings;
    settings.equations = Equations::kPolar;
    settings.clamped = false;
    const Vector3d F(0.01 * std::sin(azimuth), -1, 0.01 * std::cos(azimuth));
    const Vector3d e = Vector3d(0, -1, 9e-5).normalized();
    Moving<double> moving({Free(1, e, 1e-9)}, settings);
    moving.Step(Kernels(), Still(F, 0.01));
    // Its part in the plane, of either sign.
    const Vector3d now = moving.Directions(0)[0];
    EXPECT_GT(now.dot(e - e.y() * Vector3d::UnitY()) * std::cos(azimuth) * std::cos(azimuth), 0);
    EXPECT_LT((now - e).norm(), 1.8e-4 * std::abs(std::sin(azimuth)) + 1e-8);
  }
}

// And of its step what lies in that plane.
TEST(MotionLawTest, LeavingTheAxisKeepsTheStepInThePlane) {
  for (const double y : {1.0, -1.0}) {
    for (const double azimuth : {0.2, 1.0, 2.0, 3.0, -2.0}) {
      MotionSettings settings;
      settings.equations = Equations::kPolar;
      settings.clamped = false;
      const Vector3d level(std::sin(azimuth), 0, std::cos(azimuth)), e(0, y, 0), rate(0, 0, 0.1);
      Moving<double> moving({Free(1, e, 1e-9)}, settings);
      moving.Set(0, std::span(&e, 1), std::span(&rate, 1), 0.01);
      moving.Step(Kernels(), Still(level, 0.01));
      EXPECT_LT((moving.Steps(0)[0] - 0.01 * rate.dot(level) * level).norm(), 1e-6);
    }
  }
}

// A held hair, 0.2 m of rho = 5e-6 and EI = 5e-9.
OwnHair Held(int segments, const Vector3d& direction) {
  constexpr double kLength = 0.2;
  OwnHair hair = Free(segments, direction, 0);
  hair.segment_length = kLength / segments;
  hair.response = ResponseOf(kLength, segments);
  hair.hold = HoldOf(5e-9, 5e-6, kLength, segments);
  return hair;
}

TEST(MotionLawTest, HeldHairStaysAtRest) {
  const Vector3d gravity(0, -9.81, 0);
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    fixtures::Random random(2);
    MotionSettings settings;
    settings.equations = equations;
    OwnHair hair = Held(12, Vector3d::UnitX());
    hair.rest = random.Directions(12);
    Moving<double> moving({hair}, settings, gravity);
    for (int i = 0; i < 500; ++i) moving.Step(Kernels(), Still(gravity, 0.03));
    for (int i = 0; i < 12; ++i) {
      EXPECT_LT((moving.Directions(0)[i] - hair.rest[i]).norm(), 1e-7);
    }
  }
}

TEST(MotionLawTest, HeldHairTurnsAsACantilever) {
  constexpr double kLength = 0.2, kAcceleration = 1e-4;
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    MotionSettings settings;
    settings.equations = equations;
    settings.clamped = false;
    OwnHair hair = Held(10, {0.3, 0.5, 1});
    hair.friction = 0.2;
    const Vector3d across = hair.rest[0].cross(Vector3d::UnitY()).normalized();
    Moving<double> moving({hair}, settings);
    for (int i = 0; i < 4000; ++i) moving.Step(Kernels(), Still(kAcceleration * across, 0.02));
    for (int i = 0; i < 10; ++i) {
      const double s = (i + 0.5) / 10 * kLength;
      const double beam =
          kAcceleration * 5e-6 / (6 * 5e-9) * (std::pow(kLength, 3) - std::pow(kLength - s, 3));
      EXPECT_NEAR(Angle(moving.Directions(0)[i], hair.rest[i]) / beam, 1, 1e-3) << i;
    }
  }
}

TEST(MotionLawTest, TipsSwingAsBeamsAndNearlyAsChains) {
  constexpr double kLength = 0.2, kRigidity = 5e-9, kDensity = 5e-6;
  const double beam = std::pow(1.8751, 4) * kRigidity / (kDensity * std::pow(kLength, 4));
  const double held =
      ResponseOf(kLength, 200).back() * HoldOf(kRigidity, kDensity, kLength, 200).back();
  EXPECT_NEAR(std::sqrt(held / beam), 1, 0.02);
  const double chain = std::pow(2.4048 / 2, 2) / kLength;  // Over g.
  EXPECT_NEAR(std::sqrt(ResponseOf(kLength, 200).back() / chain), 1, 0.21);
}

TEST(MotionLawTest, PublishedResponseIsThatOfTheInertiaMoments) {
  constexpr double kD = 0.5, kUnit = 2;
  constexpr int kSegments = 18;
  const auto lambda = PublishedResponse(kD, kUnit, kSegments);
  for (int i = 1; i <= kSegments; ++i) {
    // c u = d / 2 over I_i = rho k^3 d^2 / (3 i), per rho = 1 of length kUnit.
    const double inertia = kUnit * std::pow(kSegments, 3) * kD * kD / (3.0 * i);
    EXPECT_NEAR(lambda[i - 1], kD / 2 / inertia, 1e-15);
  }
}

// Very much friction: hair turns with the head; and without, under no field, it keeps its
// direction.
TEST(MotionLawTest, FrictionTurnsHairWithTheHead) {
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    for (const bool friction : {false, true}) {
      MotionSettings settings;
      settings.equations = equations;
      OwnHair hair = Held(6, {1, 0.2, 0.5});
      hair.hold.assign(6, friction ? 10 : 0);
      hair.friction = friction ? 1e5 : 0;
      Moving<double> moving({hair}, settings);
      const double dt = 0.01;
      MotionDrive drive = Still(Vector3d::Zero(), dt);
      drive.spin = drive.spin_before = {0.3, 2, 0.1};
      for (int i = 1; i <= 50; ++i) {
        drive.head.q = math::FromRotationVector(i * dt * drive.spin);
        moving.Step(Kernels(), drive);
      }
      for (int i = 1; i < 6; ++i) {
        const Vector3d expected = friction ? drive.head.q * hair.rest[i] : hair.rest[i];
        EXPECT_LT((moving.Directions(0)[i] - expected).norm(), 2e-2);
      }
    }
  }
}

TEST(MotionLawTest, DragMakesHairFollowTheWind) {
  MotionSettings settings;
  settings.clamped = false;
  OwnHair hair = Free(3, Vector3d::UnitX(), 5);
  hair.drag = 4;
  Moving<double> moving({hair}, settings);
  const Vector3d wind(0, 0, 3);
  for (int i = 0; i < 1000; ++i) moving.Step(Kernels(), Still(Vector3d::Zero(), 0.02), wind);
  EXPECT_LT(Angle(moving.Directions(0)[2], Vector3d::UnitZ()), 1e-3);
  // Still air drags at what moves with its root.
  Moving<double> dragged({hair}, settings);
  MotionDrive drive = Still(Vector3d::Zero(), 0.02);
  drive.velocity = drive.velocity_before = {0, 1, 0};
  for (int i = 0; i < 1000; ++i) dragged.Step(Kernels(), drive);
  EXPECT_LT(Angle(dragged.Directions(0)[2], -Vector3d::UnitY()), 1e-3);
}

// Under the acceleration of its root alone, hair behaves as under the opposite field.
TEST(MotionLawTest, RootsAccelerateWithTheHead) {
  MotionSettings settings;
  settings.clamped = false;
  OwnHair hair = Free(3, Vector3d::UnitY(), 2);
  hair.root = {0.1, 0, 0};
  const double dt = 1e-3;
  const auto step = [&](MotionDrive drive) {
    Moving<double> moving({hair}, settings);
    moving.Step(Kernels(), drive);
    return moving.Steps(0)[2];
  };
  MotionDrive pushed = Still(Vector3d::Zero(), dt);
  pushed.velocity = {0, 0, 3 * dt};
  EXPECT_LT((step(pushed) - step(Still({0, 0, -3}, dt))).norm(), 1e-12);
  // Turning evenly about Y, a root 0.1 m off it is drawn in by omega^2 r, along where it was at the
  // beginning of the step.
  MotionDrive turned = Still(Vector3d::Zero(), dt);
  turned.spin = turned.spin_before = {0, 20, 0};
  EXPECT_LT((step(turned) - step(Still({40, 0, 0}, dt))).norm(), 0.03 * step(turned).norm());
}

}  // namespace
}  // namespace mane::beam
