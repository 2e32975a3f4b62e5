// Laws of a head whose guides are beams:
//   rest        it keeps the nodes of the groom's rest shape, of any hair, standing still
//   bodies      its rest shape is that to which hair settled among them
//   workers     any number of them gives the same bits; a copy of the state replays them
//   teleport    the shape goes along, seen from the head
//   lengths     no guide is ever longer than it is, nor leaves its root; all is finite
//   hull        nodes stay out of the ellipsoid that stands for the scalp, roots and rest shape too
//   segments    as many as radians that guides turn by at rest, unless they are asked for
//   places      nodes are on the curve that they follow, a stride from each other, whatever its
//   coils weight      a guide weighs what it does, whatever is lost of its length

#include "head/beams.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <utility>

#include "groom/assemble.h"
#include "groom/generate.h"
#include "head/frame.h"
#include "head/model_switch.h"
#include "head/polyline.h"
#include "head/sample_groom.h"
#include "head/test_beams.h"

namespace mane::head {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// Hair on a scalp that is a mesh: an egg, no ellipsoid.
std::shared_ptr<const groom::Groom> MeshGroom() {
  constexpr int kRings = 24, kSpokes = 32;
  groom::TriangleMesh mesh;
  for (int i = 0; i <= kRings; ++i) {
    const double t = std::numbers::pi * i / kRings;
    for (int j = 0; j < kSpokes; ++j) {
      const double f = 2 * std::numbers::pi * j / kSpokes;
      const double across = 0.08 * std::sin(t) * (1 + 0.12 * std::cos(t));
      mesh.vertices.emplace_back(
          Vector3d(across * std::sin(f), 0.11 * std::cos(t), 1.15 * across * std::cos(f))
              .cast<float>());
    }
  }
  const auto at = [](int i, int j) { return static_cast<uint32_t>(i * kSpokes + j % kSpokes); };
  for (int i = 0; i < kRings; ++i) {
    for (int j = 0; j < kSpokes; ++j) {
      if (i > 0) mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i, j + 1)});
      if (i + 1 < kRings) mesh.triangles.push_back({at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)});
      if (i < kRings / 3) {
        for (size_t n = mesh.hair_triangles.empty() ? 0 : mesh.hair_triangles.back() + 1;
             n < mesh.triangles.size(); ++n) {
          mesh.hair_triangles.push_back(static_cast<uint32_t>(n));
        }
      }
    }
  }
  groom::Generation generation;
  generation.hair_type = groom::HairType::kCaucasianWavy;
  generation.guide_count = 40;
  generation.length_m = 0.2;
  groom::Parts parts;
  parts.scalp = std::move(mesh);
  parts.guides = *groom::Generate(parts.scalp, generation, {});
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

// Straight hair about an ellipsoid's pole, of which so many guides grow inward.
std::shared_ptr<const groom::Groom> PoleGroom(int inward) {
  groom::Generation generation;
  generation.hair_type = groom::HairType::kAsianSmooth;
  generation.guide_count = 40;
  generation.length_m = 0.1;
  groom::Parts parts;
  parts.scalp = groom::Ellipsoid{{0, 0, 0}, {0.08, 0.11, 0.1}, {0, 1, 0}, 0.5};
  parts.guides = *groom::Generate(parts.scalp, generation, {});
  for (groom::Guide& guide : parts.guides) {
    for (Vector3d& natural : guide.strand.natural) natural.setZero();
  }
  for (int i = 0; i < inward; ++i) {
    math::Pose& root = parts.guides[i].root;
    root.q = root.q * math::FromRotationVector({0, 0, std::numbers::pi});
  }
  return *groom::Assemble(std::move(parts), {}, nullptr);
}

// Every groom with every number.
std::vector<std::pair<std::shared_ptr<const groom::Groom>, int>> Together(
    const std::vector<std::shared_ptr<const groom::Groom>>& grooms,
    const std::vector<int>& numbers) {
  std::vector<std::pair<std::shared_ptr<const groom::Groom>, int>> pairs;
  for (const auto& groom : grooms) {
    for (const int number : numbers) pairs.emplace_back(groom, number);
  }
  return pairs;
}

TEST(BeamsTest, NodesLieOnTheRestShapeAtEqualDistances) {
  exec::WorkerPool pool(1);
  for (const auto& [groom, segments] : Together(TestGrooms(), {0, 2, 8, 16, 64})) {
    BeamOptions options;
    options.segments = segments;
    options.avoid_head = false;
    const auto beams = MakeBeams(*groom, nullptr, options, pool);
    HeadState state = AtRest(*groom, {});
    const int fine = 1021;
    const std::vector<Vector3f> curve = Points(*groom, state, fine, pool);
    StartBeams(beams, &state);
    const int nodes = beams->segments + 1;
    const std::vector<Vector3f> own = Points(*groom, state, nodes, pool);
    for (int guide = 0; guide < groom->guide_count(); ++guide) {
      const double L = groom->guides[guide].strand.TotalLength();
      const double d = beams->segment_length[guide];
      EXPECT_LE(d * (nodes - 1), L * (1 + 1e-6));
      for (int j = 0; j < nodes; ++j) {
        const Vector3f node = own[guide * nodes + j];
        if (j > 0) {
          EXPECT_NEAR((node - own[guide * nodes + j - 1]).norm(), d, 1e-5 * L);
        }
        double nearest = 1;
        for (int i = 0; i < fine; ++i) {
          nearest = std::min<double>(nearest, (curve[guide * fine + i] - node).norm());
        }
        // Between two points of the curve; those of a coil are far apart.
        EXPECT_LT(nearest, 0.75 * L / (fine - 1) + 1e-4 * L) << guide << " " << j;
      }
      EXPECT_LT((own[guide * nodes + nodes - 1] - curve[guide * fine + fine - 1]).norm(), d);
    }
  }
}

TEST(BeamsTest, SegmentsAreAsManyAsRadiansThatGuidesTurnBy) {
  exec::WorkerPool pool(1);
  for (const auto& groom : TestGrooms()) {
    constexpr int kFine = 2001;
    const std::vector<Vector3f> curve = Points(*groom, AtRest(*groom, {}), kFine, pool);
    std::vector<double> turning(groom->guide_count(), 0);
    for (int guide = 0; guide < groom->guide_count(); ++guide) {
      const Vector3f* const own = &curve[static_cast<size_t>(guide) * kFine];
      // Over several edges, so that rounding of points turns none of them much.
      for (int i = 8; i + 8 < kFine; i += 8) {
        const Vector3d a = (own[i] - own[i - 8]).cast<double>(),
                       b = (own[i + 8] - own[i]).cast<double>();
        turning[guide] += std::atan2(a.cross(b).norm(), a.dot(b));
      }
    }
    std::ranges::sort(turning);
    const double expected = turning[static_cast<size_t>(0.95 * (turning.size() - 1))];
    EXPECT_NEAR(groom->turning, expected, 0.1 * expected + 0.2);
    EXPECT_NEAR(SegmentsOf(*groom, {}), std::clamp(groom->turning, 16.0, 64.0), 1);
    BeamOptions options;
    options.segments = 5;
    EXPECT_EQ(SegmentsOf(*groom, options), 5);
    EXPECT_EQ(MakeBeams(*groom, nullptr, options, pool)->segments, 5);
  }
}

TEST(BeamsTest, RestStaysAtRestAndResetBringsItBack) {
  exec::WorkerPool pool(2);
  for (const auto& groom : TestGrooms()) {
    HeadState state = AtRest(*groom, {});
    StartBeams(MakeBeams(*groom, nullptr, {}, pool), &state);
    const auto start = Points(*groom, state, 17, pool);
    for (int i = 0; i < 180; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
    EXPECT_LT(Farthest(Points(*groom, state, 17, pool), start), 1e-5);
    Shake(*groom, 30, &state, pool);
    EXPECT_GT(Farthest(Points(*groom, state, 17, pool), start), 0.01);
    Reset(*groom, &state);
    Teleport(*groom, {}, &state);
    EXPECT_LT(Farthest(Points(*groom, state, 17, pool), start), 1e-6);
  }
}

TEST(BeamsTest, AmongBodiesRestIsWhereHairSettled) {
  exec::WorkerPool pool(2);
  groom::Groom groom = *GeneratedGroom(groom::HairType::kAsianSmooth, 12, 0.25, 0);
  groom.scalp_friction = groom::Friction{};
  contact::FieldCache fields({}, size_t{1} << 20, 1);
  const auto bodies = *MakeBodies(groom, &fields, pool);
  HeadState state = AtRest(groom, {});
  const auto solved = Points(groom, state, 17, pool);
  StartContact(groom, bodies, &state);
  const auto settled = Points(groom, state, 17, pool);
  ASSERT_GT(Farthest(settled, solved), 5e-3);
  SwitchModel(groom, MakeBeams(groom, bodies.get(), {}, pool), 17, &state, pool);
  for (int i = 0; i < 60; ++i) Advance(groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
  EXPECT_LT(Farthest(Points(groom, state, 17, pool), settled), 2e-3);
  SwitchModel(groom, nullptr, 17, &state, pool);
  for (int i = 0; i < 60; ++i) Advance(groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
  EXPECT_LT(Farthest(Points(groom, state, 17, pool), settled), 2e-3);
}

TEST(BeamsTest, AnyNumberOfWorkersGivesTheSameBits) {
  const auto groom = SampleGroom(75, 5);
  const auto run = [&](int workers) {
    exec::WorkerPool pool(workers);
    HeadState state = AtRest(*groom, Shaken(0));
    BeamOptions options;
    options.fluctuation = 0.02;
    StartBeams(MakeBeams(*groom, nullptr, options, pool), &state);
    Shake(*groom, 20, &state, pool);
    const HeadState copy = state;
    SwitchModel(*groom, nullptr, 16, &state, pool);
    Shake(*groom, 3, &state, pool);
    SwitchModel(*groom, MakeBeams(*groom, nullptr, options, pool), 16, &state, pool);
    Shake(*groom, 3, &state, pool);
    HeadState again = copy;
    Shake(*groom, 1, &again, pool);
    return EncodeFrame(*groom, state, {}, pool) + EncodeFrame(*groom, again, {}, pool);
  };
  const std::string expected = run(1);
  for (const int workers : {2, 3, 8}) EXPECT_EQ(run(workers), expected) << workers;
}

TEST(BeamsTest, TeleportTakesTheShapeAlong) {
  const auto groom = SampleGroom(9, 5);
  exec::WorkerPool pool(1);
  HeadState state = AtRest(*groom, Shaken(0));
  StartBeams(MakeBeams(*groom, nullptr, {}, pool), &state);
  Shake(*groom, 25, &state, pool);
  HeadState moved = state;
  const math::Pose target{{3, -1, 2}, math::FromRotationVector({1, 2, -0.5})};
  Teleport(*groom, target, &moved);
  EXPECT_LT(Farthest(Points(*groom, moved, 16, pool), Points(*groom, state, 16, pool)), 1e-6);
  EXPECT_EQ(moved.pose.p, target.p);
  // Speeds go along, too: what follows is the same where the world is turned with the head.
  Environment turned;
  turned.gravity = target.q * state.pose.q.conjugate() * turned.gravity;
  Advance(*groom, {state.pose, 1 / 60.0, 1}, {}, &state, pool);
  Advance(*groom, {target, 1 / 60.0, 1}, turned, &moved, pool);
  EXPECT_LT(Farthest(Points(*groom, moved, 16, pool), Points(*groom, state, 16, pool)), 2e-5);
}

TEST(BeamsTest, HostileMotionKeepsLengthsAndIsFinite) {
  const auto groom = SampleGroom(40, 6);
  exec::WorkerPool pool(1);
  for (const bool bounded : {true, false}) {
    for (const beam::Equations equations : {beam::Equations::kAcross, beam::Equations::kPolar}) {
      BeamOptions options;
      options.bounded = bounded;
      options.equations = equations;
      options.fluctuation = 0.5;
      options.clamped = equations == beam::Equations::kAcross;
      HeadState state = AtRest(*groom, {});
      StartBeams(MakeBeams(*groom, nullptr, options, pool), &state);
      Environment storm;
      storm.wind = {90, 0, -60};
      storm.wind_variation = {1.5, 0.5, 30, 0.1, 3};
      storm.gravity = {0, -300, 500};
      for (int i = 1; i <= 200; ++i) {
        const math::Pose to{{std::sin(40.0 * i), std::cos(70.0 * i), 0.1 * i},
                            math::FromRotationVector({2 * std::sin(9.0 * i), 3, i * 1.0})};
        Advance(*groom, {to, i % 7 == 0 ? 0.9 : 1 / 60.0, 1 + i % 3}, storm, &state, pool);
        if (i % 20 == 0) {
          SwitchModel(*groom,
                      state.beams.active ? nullptr : MakeBeams(*groom, nullptr, options, pool), 16,
                      &state, pool);
        }
        ExpectLengths(*groom, Points(*groom, state, 16, pool), 16);
      }
    }
  }
}

TEST(BeamsTest, EveryTenthStepDraws) {
  const auto groom = SampleGroom(8, 5);
  exec::WorkerPool pool(1);
  HeadState state = AtRest(*groom, {});
  BeamOptions options;
  options.fluctuation = 0.2;
  options.segments = 16;
  StartBeams(MakeBeams(*groom, nullptr, options, pool), &state);
  auto last = Points(*groom, state, 17, pool);
  for (int frame = 0; frame < 30; ++frame) {
    Advance(*groom, {{}, 1 / 60.0, 2}, {}, &state, pool);
    const auto now = Points(*groom, state, 17, pool);
    // Two steps a frame.
    if (frame % 5 == 0) {
      EXPECT_GT(Farthest(now, last), 8e-3) << frame;
    } else {
      EXPECT_LT(Farthest(now, last), 6e-3) << frame;
    }
    last = now;
  }
}

TEST(BeamsTest, NodesStayOutOfTheScalp) {
  exec::WorkerPool pool(2);
  const auto groom = GeneratedGroom(groom::HairType::kAsianSmooth, 60, 0.25, 6);
  const auto beams = MakeBeams(*groom, nullptr, {}, pool);
  ASSERT_TRUE(beams->batch.settings().hull);
  const beam::Hull& hull = *beams->batch.settings().hull;
  HeadState state = AtRest(*groom, {});
  StartBeams(beams, &state);
  double farthest = 0;
  for (int i = 0; i < 120; ++i) {
    Environment wind;
    wind.wind = {12 * std::sin(0.05 * i), 0, 12 * std::cos(0.05 * i)};
    Advance(*groom, {Shaken(i / 60.0), 1 / 60.0, 1}, wind, &state, pool);
    for (const Vector3f& node : Points(*groom, state, beams->segments + 1, pool)) {
      EXPECT_GT(hull.At(node.cast<double>()), -1e-4);
      farthest = std::max(farthest, hull.At(node.cast<double>()));
    }
  }
  EXPECT_GT(farthest, 1);
}

TEST(BeamsTest, TheHullLeavesRootsAndRestShapeOutside) {
  exec::WorkerPool pool(1);
  const auto mesh = MeshGroom();
  const auto beams = MakeBeams(*mesh, nullptr, {}, pool);
  ASSERT_TRUE(beams->batch.settings().hull);
  const beam::Hull& hull = *beams->batch.settings().hull;
  EXPECT_GT(hull.radii.minCoeff(), 0.025);  // Some of this hair hangs through the forehead.
  HeadState state = AtRest(*mesh, {});
  StartBeams(beams, &state);
  for (const Vector3f& node : Points(*mesh, state, beams->segments + 1, pool)) {
    EXPECT_GT(hull.At(node.cast<double>()), 0);
  }
  EXPECT_FALSE(MakeBeams(*SampleGroom(4, 3), nullptr, {}, pool)->batch.settings().hull);
  BeamOptions off;
  off.avoid_head = false;
  EXPECT_FALSE(MakeBeams(*mesh, nullptr, off, pool)->batch.settings().avoid_hull);
}

TEST(BeamsTest, AGuideThroughTheHeadTakesNothingFromTheHullAndRestsOutside) {
  exec::WorkerPool pool(1);
  const auto hull_of = [&](int inward) {
    return MakeBeams(*PoleGroom(inward), nullptr, {}, pool)->batch.settings().hull;
  };
  const auto whole = hull_of(0);
  ASSERT_TRUE(whole);
  EXPECT_GT(whole->radii.minCoeff(), 0.075);
  const auto groom = PoleGroom(1);
  const auto beams = MakeBeams(*groom, nullptr, {}, pool);
  const beam::Hull& hull = *beams->batch.settings().hull;
  EXPECT_GT(hull.radii.minCoeff(), 0.075);
  HeadState state = AtRest(*groom, {});
  StartBeams(beams, &state);
  const int nodes = beams->segments + 1;
  const auto start = Points(*groom, state, nodes, pool);
  // Clamped, it leads into the head at first.
  for (int j = 2; j < nodes; ++j) EXPECT_GT(hull.At(start[j].cast<double>()), 0) << j;
  for (int i = 0; i < 60; ++i) Advance(*groom, {{}, 1 / 60.0, 1}, {}, &state, pool);
  EXPECT_LT(Farthest(Points(*groom, state, nodes, pool), start), 1e-3);
  const auto half = hull_of(20);  // Those are too many to be turned.
  EXPECT_TRUE(!half || half->radii.minCoeff() < 0.04);
}

std::vector<Vector3f> Coil(double radius, double rise, double length, int edges) {
  std::vector<Vector3f> curve;
  const double turn = 1 / std::hypot(radius, rise);  // Of the coil, per arc length.
  for (int i = 0; i <= edges; ++i) {
    const double a = turn * length * i / edges;
    curve.emplace_back(
        Vector3d(radius * std::cos(a), -rise * a, radius * std::sin(a)).cast<float>());
  }
  return curve;
}

Vector3d At(const std::vector<Vector3f>& curve, double place) {
  const auto i = std::min(static_cast<size_t>(place), curve.size() - 2);
  const auto part = static_cast<float>(place - static_cast<double>(i));
  return ((1 - part) * curve[i] + part * curve[i + 1]).cast<double>();
}

TEST(PolylineTest, StridesFollowACircleExactly) {
  // k strides along a circle's arc of angle A are chords 2 r sin(A / (2 k)).
  constexpr int kFine = 4000, kStrides = 12;
  const double r = 0.1, A = 4;
  const std::vector<Vector3f> curve = Coil(r, 0, r * A, kFine);
  std::vector<double> places(kStrides);
  const double d = Stride(curve, r * A, places);
  EXPECT_NEAR(d, 2 * r * std::sin(A / (2 * kStrides)), 1e-5 * d);
  std::vector<Vector3d> directions(kStrides);
  Between(curve, places, directions);
  for (int i = 0; i < kStrides; ++i) {
    EXPECT_NEAR(places[i], kFine * (i + 1.0) / kStrides, 0.1);
    const double a = A * (i + 0.5) / kStrides;
    EXPECT_LT((directions[i] - Vector3d(-std::sin(a), 0, std::cos(a))).norm(), 1e-3);
  }
}

TEST(PolylineTest, AllPlacesAreAStrideApartOnAnyCoil) {
  constexpr double kLength = 0.25;
  double most_left = 0;
  for (const double radius : {1e-3, 2e-3, 4e-3, 7e-3, 0.012, 0.02, 0.04, 0.1}) {
    for (const double steep : {0.05, 0.2, 0.6, 2.0}) {
      const std::vector<Vector3f> curve = Coil(radius, steep * radius, kLength, 1024);
      for (int k = 2; k <= 64; ++k) {
        std::vector<double> places(k);
        const double d = Stride(curve, kLength, places);
        EXPECT_LE(d, kLength / k);
        Vector3d node = At(curve, 0);
        double last = 0;
        std::vector<Vector3d> directions(k);
        Between(curve, places, directions);
        Vector3d end = node;
        for (int i = 0; i < k; ++i) {
          ASSERT_GT(places[i], last) << radius << " " << steep << " " << k;
          ASSERT_LE(places[i], 1024);
          const Vector3d next = At(curve, places[i]);
          ASSERT_NEAR((next - node).norm(), d, 1e-5 * d + 1e-7);
          node = next;
          last = places[i];
          end += d * directions[i];
          ASSERT_LT((end - node).norm(), 1e-5 * kLength);
        }
        most_left = std::max(most_left, (At(curve, 1024) - node).norm() / d);
      }
    }
  }
  EXPECT_LT(most_left, 1);
}

TEST(PolylineTest, AStraightLineIsFollowedToItsEnd) {
  const std::vector<Vector3f> curve = {{0, 0, 0}, {0, 0, 2}};
  std::vector<double> places(5);
  EXPECT_NEAR(Stride(curve, 2, places), 0.4, 1e-7);
  EXPECT_NEAR(places[4], 1, 1e-6);
  // Where hair is folded so that two places meet, the direction is that before.
  const std::vector<Vector3f> folded = {{0, 0, 0}, {1, 0, 0}, {0, 0, 0}};
  std::vector<Vector3d> directions(2);
  Between(folded, std::vector<double>{0.5, 1.5}, directions);
  EXPECT_EQ(directions[0], Vector3d::UnitX());
  EXPECT_EQ(directions[1], Vector3d::UnitX());
}

}  // namespace
}  // namespace mane::head
