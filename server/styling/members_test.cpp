// Laws of members:
//   lengths     follow l(u), for every form of it
//   radius      |d_k| <= r_k from the second point on
//   fuzziness   noise grows with sigma; sigma = 0 scales the root's displacement
//   bends       a wisp keeps its cross section
//   obstacles   no control point is inside
//   workers     one or many make the same bits

#include "styling/members.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

#include "math/random.h"
#include "styling/distribution.h"
#include "styling/kolmogorov.h"

namespace mane::styling {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Form = Distribution::Form;
constexpr double kSegment = 0.01;
constexpr Distribution kOwnLength{Form::kConstant, 1, 0, 0, 2, {}};
constexpr double kPi = std::numbers::pi;

struct Scene {
  Roots roots;
  Masters masters;
  Obstacles obstacles;
  Distribution length = kOwnLength;
  std::vector<double> radii{0.01};
  double fuzziness = 0.3;
};

// One more wisp: the master's segments have the given headings in the x-y plane, its own length is
// `own` segments; roots lie at random in a disc about its root, within `spread`.
void AddWisp(Scene& scene, const Vector3d& root, std::span<const double> headings, double own,
             int strands, double spread, const Vector3f& delta = Vector3f::Zero()) {
  Masters& masters = scene.masters;
  if (masters.first_joint.empty()) masters.first_joint.push_back(0);
  if (scene.roots.first_member.empty()) scene.roots.first_member.push_back(0);
  masters.segment_length = kSegment;
  Vector3d c = root;
  for (size_t i = 0; i <= headings.size(); ++i) {
    const double heading = headings[std::min(i, headings.size() - 1)];
    masters.frames.emplace_back(Eigen::AngleAxisf(static_cast<float>(heading), Vector3f::UnitZ()));
    masters.outline.emplace_back(c.cast<float>());
    masters.details.push_back(i % 2 == 0 ? Vector3f::Zero() : delta);
    masters.points.push_back(masters.outline.back() +
                             masters.frames.back() * masters.details.back());
    c += kSegment * Vector3d(std::cos(heading), std::sin(heading), 0);
  }
  masters.first_joint.push_back(static_cast<uint32_t>(masters.details.size()));
  masters.length.push_back(static_cast<float>(own * kSegment));
  scene.roots.masters.push_back({root, Vector3d::UnitX(), -1});
  math::RandomStream random(4, scene.roots.masters.size());
  for (int i = 0; i < strands; ++i) {
    const double r = spread * std::sqrt(random.Uniform()), angle = random.Uniform(0, 2 * kPi);
    const Vector3d off(0, r * std::cos(angle), r * std::sin(angle));
    scene.roots.members.emplace_back(
        (root + Eigen::AngleAxisd(headings[0], Vector3d::UnitZ()) * off).cast<float>());
  }
  scene.roots.first_member.push_back(static_cast<uint32_t>(scene.roots.members.size()));
}

std::vector<double> Straight(int segments) { return std::vector<double>(segments, 0.0); }

std::vector<double> Turning(int segments, double angle) {
  std::vector<double> headings;
  for (int i = 0; i < segments; ++i) headings.push_back(angle * i / (segments - 1));
  return headings;
}

Members Grow(const Scene& scene, int workers = 1, uint64_t seed = 8) {
  exec::WorkerPool pool(workers);
  return MakeMembers(scene.roots, scene.masters, scene.obstacles, scene.length, scene.radii,
                     scene.fuzziness, seed, pool);
}

double LengthOf(std::span<const Vector3f> strand) {
  double length = 0;
  for (size_t i = 1; i < strand.size(); ++i) length += (strand[i] - strand[i - 1]).norm();
  return length;
}

// Calls visit(strand, k, p_k - p_k^M) for all points but roots and tips.
void ForEachDisplacement(const Scene& scene, const Members& members,
                         const std::function<void(int, int, const Vector3f&)>& visit) {
  for (int wisp = 0; wisp < scene.roots.wisps(); ++wisp) {
    const uint32_t joint = scene.masters.first_joint[wisp];
    for (auto i = static_cast<int>(scene.roots.first_member[wisp]);
         i < static_cast<int>(scene.roots.first_member[wisp + 1]); ++i) {
      const auto strand = members.strand(i);
      for (int k = 1; k + 1 < static_cast<int>(strand.size()); ++k) {
        visit(i, k, strand[k] - scene.masters.points[joint + k]);
      }
    }
  }
}

TEST(MembersTest, LengthsFollowTheirDistribution) {
  const Distribution forms[] = {{Form::kUniform, 0, 0, 0.3, 1.6, {}},
                                {Form::kNormal, 0.9, 0.2, 0.1, 1.3, {}},
                                {Form::kSampled, 0, 0, 0.2, 1.2, {0, 0, 1, 3, 0.5}}};
  for (const Distribution& form : forms) {
    Scene scene;
    scene.length = form;
    const double own = 8.6;
    const double reach = Reach(form, own * kSegment, scene.radii) / kSegment;
    const int segments = static_cast<int>(std::ceil(reach));
    for (int wisp = 0; wisp < 500; ++wisp) {
      AddWisp(scene, Vector3d(0, 0.1 * wisp, 0), Turning(segments, 1), own, 100, 0.005,
              Vector3f(0, 0.001F, 0));
    }
    const Members members = Grow(scene);
    // The master's own length: eight whole segments of its polyline, and 0.6 of the ninth.
    const auto master = std::span<const Vector3f>(scene.masters.points).first(9);
    const double length =
        LengthOf(master) + 0.6 * (scene.masters.points[9] - scene.masters.points[8]).norm();
    std::vector<double> sample;
    for (int i = 0; i < members.strands(); ++i) {
      sample.push_back(LengthOf(members.strand(i)) / length);
    }
    ASSERT_EQ(sample.size(), 50000U);
    const Quantile quantile(form);
    EXPECT_LT(KolmogorovSmirnov(sample, [&](double u) { return quantile.Cdf(u); }),
              kKolmogorovSmirnovLimit);
  }
}

TEST(MembersTest, AConstantLengthIsMetByEveryStrand) {
  Scene scene;
  scene.length.mean = 0.73;
  AddWisp(scene, Vector3d::Zero(), Turning(14, 2), 10, 500, 0.01);
  const Members members = Grow(scene);
  for (int i = 0; i < 500; ++i) {
    EXPECT_NEAR(LengthOf(members.strand(i)), 0.073, 1e-7);  // Rounding of ten float32 segments.
  }
}

TEST(MembersTest, DisplacementsStayWithinTheRadius) {
  for (double fuzziness : {0.0, 0.1, 1.0, 5.0}) {
    Scene scene;
    scene.fuzziness = fuzziness;
    scene.radii = {0.004, 0.012, 0, 0.006};
    // Roots reach farther out than the radius there.
    for (int wisp = 0; wisp < 20; ++wisp) {
      AddWisp(scene, Vector3d(0, wisp, 0), Turning(30, 2), 24, 100, 0.02);
    }
    int visited = 0;
    const Members members = Grow(scene);
    ForEachDisplacement(scene, members, [&](int, int k, const Vector3f& d) {
      const double at = std::min(1.0, k / 24.0) * 3;
      const int i = std::min(2, static_cast<int>(at));
      const double r = scene.radii[i] + (at - i) * (scene.radii[i + 1] - scene.radii[i]);
      // Points up to 20 m away are rounded to 1e-6 m.
      EXPECT_LE(d.norm(), r + 3e-6) << k;
      ++visited;
    });
    EXPECT_GT(visited, 20000);
    for (const Vector3f& p : members.points) EXPECT_TRUE(p.allFinite());
  }
}

TEST(MembersTest, WithoutFuzzinessTheRootsDisplacementIsScaled) {
  Scene scene;
  scene.fuzziness = 0;
  scene.radii = {0.01, 0.002};
  AddWisp(scene, Vector3d::Zero(), Turning(24, 1.2), 20, 200, 0.01);
  const Members members = Grow(scene);
  ForEachDisplacement(scene, members, [&](int i, int k, const Vector3f& d) {
    const Vector3f d1 = scene.masters.frames[0].conjugate() * scene.roots.members[i];
    const float ratio = (0.01F - 0.008F * std::min(1.0F, k / 20.0F)) / 0.01F;
    EXPECT_LT((d - scene.masters.frames[k] * Vector3f(ratio * d1)).norm(), 1e-7F);
  });
}

TEST(MembersTest, ARootFartherOutComesInToTheRadius) {
  Scene scene;
  scene.fuzziness = 0;
  scene.radii = {0.01, 0.005};
  AddWisp(scene, Vector3d::Zero(), Straight(24), 20, 0, 0);
  scene.roots.members = {Vector3f(0, 0.03F, 0)};
  scene.roots.first_member = {0, 1};
  const auto members = Grow(scene);
  for (int k = 1; k < 19; ++k) EXPECT_NEAR(members.points[k].y(), 0.01 - 0.005 * k / 20, 1e-7);
}

TEST(MembersTest, NoiseGrowsWithFuzziness) {
  double last = -1;
  for (double fuzziness : {0.0, 0.03, 0.1, 0.3, 1.0, 2.0}) {
    Scene scene;
    scene.fuzziness = fuzziness;
    for (int wisp = 0; wisp < 20; ++wisp) {
      AddWisp(scene, Vector3d(0, 0.1 * wisp, 0), Straight(30), 24, 100, 0.008);
    }
    const Members members = Grow(scene);
    double sum = 0, count = 0;
    std::vector<Vector3f> before(scene.roots.members.size());
    ForEachDisplacement(scene, members, [&](int i, int k, const Vector3f& d) {
      if (k > 1) sum += (d - before[i]).norm(), ++count;
      before[i] = d;
    });
    EXPECT_GT(sum / count, last);
    // y is uniform up to sigma r where the sphere does not cut it: half of it in the mean, at most.
    EXPECT_LE(sum / count, 0.5 * fuzziness * 0.01 * 1.02 + 1e-6);
    last = sum / count;
  }
}

TEST(MembersTest, AWispKeepsItsCrossSectionAroundABend) {
  Scene scene;
  scene.fuzziness = 0;
  AddWisp(scene, Vector3d::Zero(), Turning(16, kPi / 2), 15, 0, 0);
  for (int i = 0; i < 36; ++i) {  // A ring.
    scene.roots.members.emplace_back(0, 0.01F * std::cos(i * kPi / 18),
                                     0.01F * std::sin(i * kPi / 18));
  }
  scene.roots.first_member = {0, 36};
  const Members members = Grow(scene);
  Eigen::Matrix3f spread = Eigen::Matrix3f::Zero();
  ForEachDisplacement(scene, members, [&](int, int k, const Vector3f& d) {
    const Vector3f along = scene.masters.frames[k] * Vector3f::UnitX();
    EXPECT_NEAR(d.norm(), 0.01F, 1e-6F);
    EXPECT_NEAR(d.dot(along), 0, 1e-6F);
    if (k == 13) spread += d * d.transpose() / 36;
  });
  // There the wisp runs nearly along y; a displacement in a fixed frame would have no extent in x.
  EXPECT_NEAR(spread(0, 0), 0.5e-4, 0.05e-4);
  EXPECT_NEAR(spread(2, 2), 0.5e-4, 0.05e-4);
}

TEST(MembersTest, WhereTheRadiusIsZeroAllMeetInTheMaster) {
  Scene scene;
  scene.radii = {0.01, 0, 0.01};
  scene.fuzziness = 1;
  AddWisp(scene, Vector3d::Zero(), Straight(30), 24, 50, 0.01);
  const Members members = Grow(scene);
  double widest = 0;
  ForEachDisplacement(scene, members, [&](int, int k, const Vector3f& d) {
    EXPECT_EQ(d.norm() < 1e-8F, k == 12) << k;  // The master's length is a float32.
    if (k == 22) widest = std::max<double>(widest, d.norm());
  });
  EXPECT_GT(widest, 0.002);
  scene.radii = {0};
  ForEachDisplacement(scene, Grow(scene),
                      [&](int, int, const Vector3f& d) { EXPECT_EQ(d, Vector3f::Zero()); });
}

TEST(MembersTest, WhereJointsEndTheLastSegmentGoesOnStraight) {
  Scene scene;
  scene.fuzziness = 0;
  scene.length.mean = 1.75;
  AddWisp(scene, Vector3d::Zero(), Straight(10), 10, 3, 0.005);
  const Members members = Grow(scene);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(members.strand(i).size(), 11U);
    EXPECT_LT((members.strand(i).back() - scene.roots.members[i] - Vector3f(0.175F, 0, 0)).norm(),
              1e-6F);
  }
}

TEST(MembersTest, ReachIsEnoughAroundAHalfTurn) {
  Scene scene;
  scene.length = {Form::kUniform, 0, 0, 0.5, 1.5, {}};
  const double own = 12;
  const double reach = Reach(scene.length, own * kSegment, scene.radii);
  EXPECT_NEAR(reach, 1.5 * 0.12 + kPi * 0.01, 1e-12);
  EXPECT_NEAR(Reach({Form::kConstant, 0.5, 0, 0, 2, {}}, 0.2, scene.radii), 0.2 + kPi * 0.01,
              1e-12);
  scene.fuzziness = 0;
  // Turns against the displacement on one side, with it on the other.
  AddWisp(scene, Vector3d::Zero(), Turning(static_cast<int>(std::ceil(reach / kSegment)), kPi), own,
          2000, 0.01);
  const Members members = Grow(scene);
  for (int i = 0; i < members.strands(); ++i) {
    const auto strand = members.strand(i);
    for (size_t k = 1; k < strand.size(); ++k) {
      EXPECT_LT((strand[k] - strand[k - 1]).norm(), 2 * kSegment);
    }
    // No last span that is far shorter than the one before, either.
    if (strand.size() < 3) continue;
    EXPECT_GT((strand.back() - strand[strand.size() - 2]).norm(), 0.49 * 0.8 * kSegment);
  }
}

// Wisps that run 1 mm above an ellipsoid, all around it, and one through a capsule's side.
Scene OnAnEllipsoid() {
  Scene scene;
  scene.obstacles = {{contact::Ellipsoid{Vector3d(0.1, 0.1, 0.12)},
                      {Vector3d(0, 0, 0.01), Eigen::Quaterniond(0.9, 0, 0, 0.1).normalized()}},
                     {contact::Capsule{Vector3d(0, 0, -0.1), Vector3d(0, 0, 0.1), 0.02},
                      {Vector3d(0.128, 0, 0), Eigen::Quaterniond::Identity()}}};
  const double turn = kSegment / 0.101;
  for (int wisp = 0; wisp < 40; ++wisp) {
    const double angle = 0.9 + 0.1 * wisp;
    std::vector<double> headings;
    // Segments are chords of a circle of 102 mm, or of 101.9 in their middles.
    for (int i = 0; i < 25; ++i) headings.push_back(angle + kPi / 2 + (i + 0.5) * turn * 0.99);
    AddWisp(scene, 0.102 * Vector3d(std::cos(angle), std::sin(angle), 0), headings, 20, 60, 0.008);
  }
  scene.length = {Form::kUniform, 0, 0, 0.1, 1.2, {}};
  return scene;
}

TEST(MembersTest, NoPointIsInsideAnObstacle) {
  Scene scene = OnAnEllipsoid();
  for (double fuzziness : {0.0, 0.5}) {
    scene.fuzziness = fuzziness;
    const Members members = Grow(scene);
    Scene free = scene;
    free.obstacles.clear();
    const Members unhindered = Grow(free);
    const auto inside = [&](const Members& strands) {
      int count = 0;
      for (int i = 0; i < strands.strands(); ++i) {
        for (const Vector3f& p : strands.strand(i).subspan(1))
          count += DistanceTo(scene.obstacles, p.cast<double>()).distance < -1e-6;
      }
      return count;
    };
    EXPECT_GT(inside(unhindered), 4000);
    // Where a master is itself inside, its strands may be.
    int masters_inside = 0;
    for (const Vector3f& p : scene.masters.points) {
      masters_inside += DistanceTo(scene.obstacles, p.cast<double>()).distance < 0;
    }
    EXPECT_EQ(masters_inside, 0);
    EXPECT_EQ(inside(members), 0);
    ForEachDisplacement(scene, members,
                        [&](int, int, const Vector3f& d) { EXPECT_LE(d.norm(), 0.01F + 1e-7F); });
    for (int wisp = 0; wisp < 40; ++wisp) {  // And lengths are still exact.
      const auto i = static_cast<int>(scene.roots.first_member[wisp]);
      EXPECT_NEAR(LengthOf(members.strand(i)), LengthOf(unhindered.strand(i)), 2e-7);
    }
  }
}

TEST(MembersTest, AFarObstacleChangesNothing) {
  Scene scene = OnAnEllipsoid();
  for (auto& obstacle : scene.obstacles) obstacle.pose.p += Vector3d(0, 0, 1);
  Scene free = scene;
  free.obstacles.clear();
  EXPECT_EQ(Grow(scene).points, Grow(free).points);
}

TEST(MembersTest, IsTheSameForAnyNumberOfWorkers) {
  const Scene scene = OnAnEllipsoid();
  const Members one = Grow(scene, 1), four = Grow(scene, 4);
  EXPECT_EQ(one.first_point, four.first_point);
  EXPECT_EQ(one.points, four.points);
  EXPECT_NE(one.points, Grow(scene, 1, 9).points);
}

TEST(MembersTest, WispsWithoutMembersAreNone) {
  Scene scene;
  AddWisp(scene, Vector3d::Zero(), Straight(5), 5, 0, 0);
  AddWisp(scene, Vector3d::UnitY(), Straight(5), 5, 2, 0.01);
  EXPECT_EQ(Grow(scene).strands(), 2);
}

}  // namespace
}  // namespace mane::styling
