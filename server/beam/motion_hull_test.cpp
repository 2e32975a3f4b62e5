// Moving hair and the hull, for float and double and every instruction set:
//   outside       no node is inside, whatever moves, of hair whose root is not; evaluated in double
//   little        a node that is turned out lies on the hull, in the plane it was in
//   way out       hair whose root is inside leaves, and stays out
//   at rest       hair pressed onto the hull lies still, and does not fly off when released

#include <gtest/gtest.h>

#include <cmath>

#include "beam/motion.h"
#include "beam/test_motion.h"

namespace mane::beam {
namespace {

using Eigen::Vector3d;
using fixtures::Angle;
using fixtures::Free;
using fixtures::Moving;
using fixtures::OwnHair;
using fixtures::Random;
using fixtures::Still;

const Hull kHull{{0.01, -0.02, 0.005}, {0.08, 0.11, 0.095}};

template <typename T>
class MotionHullTest : public fixtures::EveryIsaTest<T> {};
TYPED_TEST_SUITE(MotionHullTest, fixtures::Numbers);

// Nodes in the head frame.
template <typename T>
std::vector<Vector3d> LocalNodes(const Moving<T>& moving, const KernelTable<T>& kernels, int i,
                                 const math::Pose& head) {
  std::vector<Vector3d> nodes = moving.Nodes(kernels, i, head);
  for (Vector3d& node : nodes) node = head.q.conjugate() * node;
  return nodes;
}

TYPED_TEST(MotionHullTest, NoNodeIsInside) {
  using T = TypeParam;
  constexpr int kSegments = 30, kHairs = 32;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (int kind = 0; kind < 16; ++kind) {
      SCOPED_TRACE(testing::Message() << "kind " << kind);
      Random random(500 + kind);
      MotionSettings settings;
      settings.equations = kind & 1 ? Equations::kPolar : Equations::kAcross;
      settings.clamped = kind & 2;
      if (kind & 4) settings.largest_turn.assign(kSegments, 0.4F), settings.fluctuation = 0.2;
      const Hull hull = kind & 8 ? random.AnyHull() : kHull;
      settings.hull = hull;
      std::vector<OwnHair> hairs;
      for (int i = 0; i < kHairs; ++i) {
        OwnHair& hair = hairs.emplace_back(fixtures::AnyHair(random, kSegments, hull));
        hair.rest[0] = hull.Gradient(hair.root).normalized();
        hair.segment_length = random.LogUniform(0.001, 1) * hull.radii.minCoeff();
      }
      Moving<T> moving(hairs, settings, {0, -9.81, 0});
      for (int step = 0; step < 60; ++step) {
        MotionDrive drive = fixtures::AnyDrive(random, random.Uniform(0.005, 0.05));
        drive.frame = step;
        drive.gravity = random.Vector(step % 10 == 0 ? 1e5 : 100);
        moving.Step(kernels, drive);
        for (int i = 0; i < kHairs; ++i) {
          const auto nodes = LocalNodes(moving, kernels, i, drive.head);
          for (size_t s = 1; s < nodes.size(); ++s) {
            ASSERT_GE(hull.At(nodes[s]), 0) << "step " << step << " hair " << i << " node " << s;
          }
        }
      }
    }
  });
}

// Segments much longer than the head that go out and come back: ends differ by what directions, and
// sums of them, round by.
TYPED_TEST(MotionHullTest, NoNodeOfLongSegmentsThatComeBackIsInside) {
  using T = TypeParam;
  constexpr int kHairs = 800, kSegments = 16;
  constexpr double kLength = 5;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
      Random random(67);
      MotionSettings settings;
      settings.equations = equations;
      settings.hull = kHull;
      std::vector<OwnHair> hairs;
      for (int i = 0; i < kHairs; ++i) {
        OwnHair& hair = hairs.emplace_back(fixtures::AnyHair(random, kSegments, kHull));
        hair.segment_length = kLength;
        const Vector3d n = kHull.Gradient(hair.root).normalized();
        for (int s = 0; s < kSegments; s += 2) {
          hair.rest[s] = (n + random.Vector(0.2)).normalized();
          const Vector3d into = 0.03 / kLength * (n + random.Vector(0.3));
          hair.rest[s + 1] = -(hair.rest[s] + into).normalized();
        }
        hair.hold.assign(kSegments, 0.0);
      }
      Moving<T> moving(hairs, settings);
      moving.Step(kernels, Still(Vector3d::Zero(), 0.02));
      int turned = 0;
      for (int i = 0; i < kHairs; ++i) {
        const auto nodes = moving.Nodes(kernels, i), e = moving.Directions(i);
        for (int s = 1; s <= kSegments; ++s) {
          ASSERT_GE(kHull.At(nodes[s]), 0) << "hair " << i << " node " << s;
          turned += (e[s - 1] - hairs[i].rest[s - 1]).norm() > 1e-4 ? 1 : 0;
        }
      }
      EXPECT_GT(turned, 2 * kHairs);
    }
  });
}

TYPED_TEST(MotionHullTest, NodesAreTurnedOutAsLittleAsItTakes) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
      Random random(61);
      MotionSettings settings, free;
      settings.equations = free.equations = equations;
      settings.hull = kHull;
      std::vector<OwnHair> hairs;
      for (int i = 0; i < 200; ++i) {
        OwnHair& hair = hairs.emplace_back(fixtures::AnyHair(random, 2, kHull));
        hair.segment_length = 0.02;
        hair.rest[0] = kHull.Gradient(hair.root).unitOrthogonal();
      }
      Moving<T> moving(hairs, settings), through(hairs, free);
      const MotionDrive drive = Still(random.Vector(1e4), 0.05);
      moving.Step(kernels, drive);
      through.Step(kernels, drive);
      int turned = 0;
      for (int i = 0; i < 200; ++i) {
        const auto e = moving.Directions(i), was = through.Directions(i);
        const Vector3d node = moving.Nodes(kernels, i)[2];
        const Vector3d would = through.Nodes(kernels, i)[2];
        if (kHull.At(would) > 1e-4) {
          EXPECT_LT((e[1] - was[1]).norm(), 1e-6);
        } else if (kHull.At(would) < -1e-4) {
          ++turned;
          EXPECT_LT(kHull.At(node), 1e-4) << i;
          // In the plane of the normal.
          const Vector3d across = kHull.Gradient(moving.Nodes(kernels, i)[1]).cross(was[1]);
          EXPECT_LT(std::abs(across.normalized().dot(e[1])), 1e-4);
          // Nearer directions of the plane end inside.
          const double angle = Angle(e[1], was[1]);
          const Vector3d u = was[1], v = (e[1] - e[1].dot(u) * u).normalized();
          for (const double part : {0.3, 0.6, 0.95}) {
            const Vector3d nearer = std::cos(part * angle) * u + std::sin(part * angle) * v;
            EXPECT_LT(kHull.At(moving.Nodes(kernels, i)[1] + 0.02 * nearer), 1e-5);
          }
        }
      }
      EXPECT_GT(turned, 20);
    }
  });
}

TYPED_TEST(MotionHullTest, HairLeavesTheHull) {
  using T = TypeParam;
  this->ForEveryIsa([&](const KernelTable<T>& kernels) {
    Random random(62);
    MotionSettings settings;
    settings.hull = kHull;
    settings.clamped = false;
    std::vector<OwnHair> hairs;
    for (int i = 0; i < 32; ++i) {
      OwnHair& hair = hairs.emplace_back(fixtures::AnyHair(random, 20, kHull));
      hair.segment_length = 0.01;
      hair.root = kHull.center + 0.7 * (hair.root - kHull.center);
    }
    Moving<T> moving(hairs, settings);
    for (int step = 0; step < 50; ++step) {
      const MotionDrive drive = fixtures::AnyDrive(random, 0.02);
      moving.Step(kernels, drive);
      for (int i = 0; i < 32; ++i) {
        const auto nodes = LocalNodes(moving, kernels, i, drive.head);
        bool out = false;
        for (int s = 1; s <= 20; ++s) {
          const double level = kHull.At(nodes[s]);
          if (!out) {
            EXPECT_GT(level, kHull.At(nodes[s - 1]));
          }
          EXPECT_TRUE(!out || level >= 0);
          out |= level >= 0;
        }
        // 0.3 of a radius below it, at most 33 mm.
        EXPECT_GE(kHull.At(nodes[5]), 0);
      }
    }
  });
}

TEST(MotionContactTest, PressedHairLiesStill) {
  for (const Equations equations : {Equations::kAcross, Equations::kPolar}) {
    MotionSettings settings;
    settings.equations = equations;
    settings.hull = kHull;
    std::vector<OwnHair> hairs;
    for (int i = 0; i < 30; ++i) {
      const Vector3d ball = DirectionOf(0.1 + 0.01 * i, i);
      OwnHair& hair = hairs.emplace_back(Free(6, Vector3d::UnitY() + 0.1 * ball, 20));
      hair.root = kHull.Point(0.1 + 0.01 * i, i);
      hair.drag = 2;
    }
    Moving<double> moving(hairs, settings);
    for (int i = 0; i < 3000; ++i) moving.Step(fixtures::Kernels(), Still({0, -10, 0}, 0.01));
    for (int i = 0; i < 30; ++i) {
      for (const Vector3d& step : moving.Steps(i)) ASSERT_LT(step.norm(), 1e-3) << i;
      // It lies on the hull.
      EXPECT_LT(kHull.At(moving.Nodes(fixtures::Kernels(), i)[3]), 1e-3);
    }
    // Released, it keeps on lying there.
    std::vector<std::vector<Vector3d>> lay;
    for (int i = 0; i < 30; ++i) lay.push_back(moving.Nodes(fixtures::Kernels(), i));
    for (int i = 0; i < 100; ++i) moving.Step(fixtures::Kernels(), Still(Vector3d::Zero(), 0.01));
    for (int i = 0; i < 30; ++i) {
      EXPECT_LT((moving.Nodes(fixtures::Kernels(), i)[6] - lay[i][6]).norm(), 1e-3);
    }
  }
}

}  // namespace
}  // namespace mane::beam
