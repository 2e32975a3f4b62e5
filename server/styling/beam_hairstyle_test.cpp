// Hair by beams on a head: the guides among all hair, the skin that it begins on, and
// that the groom made of it holds every hair where it was bent to.

#include "styling/beam_hairstyle.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "groom/import.h"
#include "groom/scalp_hull.h"
#include "styling/guides.h"
#include "styling/test_scalps.h"
#include "wire/assemble_hair.h"
#include "wire/reconstruct.h"

namespace mane::styling {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kGuides = 40;
const Vector3d kCenter(0, 0.1, 0);

groom::ImportOptions Options() {
  groom::ImportOptions options;
  options.hair_type = groom::HairType::kCaucasianWavy;
  options.element_count = 8;
  return options;
}

// Short hair all around, of different lengths, and a ponytail.
beam::BeamStyle TwoParts() {
  beam::BeamStyle style;
  style.seed = 4;
  beam::Part part;
  part.name = "all";
  part.count = 600;
  part.segments = 10;
  part.length = 0.12;
  part.length_fluctuation = 0.3;
  part.pores.greatest_zenith = 1.5;
  style.parts.push_back(part);
  beam::Part tail;
  tail.name = "tail";
  tail.count = 200;
  tail.segments = 15;
  tail.length = 0.3;
  tail.tied_at = Vector3d(0, 0.15, -0.12);
  style.parts.push_back(tail);
  beam::Cut cut;
  cut.height = 0.08;
  style.parts[0].cuts.push_back(cut);
  return style;
}

BeamHairstyle Make(const groom::Scalp& scalp, int workers = 2,
                   const beam::BeamStyle& style = TwoParts()) {
  exec::WorkerPool pool(workers);
  auto made = MakeBeamHairstyle(style, kGuides, scalp, "style", pool);
  EXPECT_TRUE(made) << made.error().message;
  return *std::move(made);
}

groom::Ellipsoid Ball() {
  groom::Ellipsoid ball;
  ball.center = kCenter;
  ball.radii = {0.08, 0.1, 0.09};
  return ball;
}

TEST(BeamHairstyle, EveryHairRidesOnALongOneOfItsPart) {
  const BeamHairstyle made = Make(Ball());
  ASSERT_EQ(made.guides.size(), size_t{kGuides});
  ASSERT_EQ(made.first_member.size(), size_t{kGuides + 1});
  ASSERT_EQ(made.members.strands(), 800);
  EXPECT_EQ(made.colours.size(), 800U);
  EXPECT_EQ(made.first_member.back(), 800U);
  int of_tail = 0;
  for (int guide = 0; guide < kGuides; ++guide) {
    const auto& points = made.guides[guide].points;
    of_tail += points.size() == 16 && points[0].z() < -0.1F ? 1 : 0;
    bool is_one = false;
    const bool behind = points[0].z() < -0.1F;
    for (uint32_t i = made.first_member[guide]; i < made.first_member[guide + 1]; ++i) {
      const auto hair = made.members.strand(static_cast<int>(i));
      EXPECT_LE(hair.size(), points.size());
      EXPECT_EQ(hair[0].z() < -0.1F, behind);
      is_one = is_one || std::ranges::equal(hair, points);
    }
    EXPECT_TRUE(is_one);
  }
  EXPECT_EQ(of_tail, kGuides / 4);  // Of the hairs a quarter.
}

TEST(BeamHairstyle, GuidesAreNoMoreThanHairsAndAtLeastOneAPart) {
  exec::WorkerPool pool(1);
  beam::BeamStyle style = TwoParts();
  const auto count = [&](int guides) {
    const auto made = MakeBeamHairstyle(style, guides, Ball(), "style", pool);
    EXPECT_TRUE(made);
    return made->guides.size();
  };
  EXPECT_EQ(count(1), 2U);
  style.parts[0].cuts.clear();
  style.parts[0].count = 10;
  style.parts[1].count = 5;
  EXPECT_EQ(count(1000), 15U);
}

TEST(BeamHairstyle, SmallPartsHaveTheirGuidesFromTheLargest) {
  exec::WorkerPool pool(1);
  beam::BeamStyle style = TwoParts();
  style.parts[0].cuts.clear();
  style.parts[1].count = 1;
  for (int i = 2; i < 6; ++i) style.parts.push_back(style.parts[1]);
  for (const int guides : {6, 20, 600}) {
    const auto made = MakeBeamHairstyle(style, guides, Ball(), "style", pool);
    ASSERT_TRUE(made);
    EXPECT_EQ(made->guides.size(), static_cast<size_t>(guides));
    for (int last = 0; last < 5; ++last) {
      const auto end = made->first_member.end() - 1 - last;
      EXPECT_EQ(end[0] - end[-1], 1U);
    }
  }
}

TEST(BeamHairstyle, BeginsOnTheSkinOfAMesh) {
  // A head that its hull, which encloses a horn, is much larger than.
  groom::TriangleMesh mesh = Dome(kCenter, 2.5, 30);
  mesh.vertices.emplace_back(0.0F, 0.23F, 0.0F);
  mesh.triangles.push_back({0, 1, static_cast<uint32_t>(mesh.vertices.size() - 1)});
  const auto hull = groom::ScalpHull(mesh);
  ASSERT_TRUE(hull);
  beam::BeamStyle style = TwoParts();
  style.parts[1].tied_at->z() = -0.2;
  const BeamHairstyle made = Make(mesh, 2, style);
  int deep = 0;
  for (int i = 0; i < made.members.strands(); ++i) {
    const auto hair = made.members.strand(i);
    const Vector3d skin = hair[0].cast<double>(), pore = hair[1].cast<double>();
    if (skin.z() < -0.19) {  // The tail begins where it is tied.
      EXPECT_NEAR(skin.z(), -0.2, 1e-6);
      continue;
    }
    EXPECT_NEAR(hull->At(pore), 0, 1e-5);
    EXPECT_GT((pore - skin).norm(), 0.999e-3);
    // On the line to the center.
    EXPECT_LT((pore - hull->center).normalized().cross(skin - hull->center).norm(), 1e-6);
    const double radius = (skin - kCenter).norm();
    if (radius > kDomeRadius + 1e-3) continue;  // On the horn, or where the hull touches the head.
    EXPECT_NEAR(radius, kDomeRadius, 2e-3);     // The dome's chords, and 1 mm.
    deep += (pore - skin).norm() > 5e-3 ? 1 : 0;
  }
  EXPECT_GT(deep, 100);
}

TEST(BeamHairstyle, BeginsAMillimetreBelowThePoreWhereTheHullTouches) {
  beam::BeamStyle style = TwoParts();
  style.parts.pop_back();
  const BeamHairstyle made = Make(Dome(kCenter, 2.5, 80), 2, style);
  for (int i = 0; i < made.members.strands(); ++i) {
    const auto hair = made.members.strand(i);
    EXPECT_GT((hair[1] - hair[0]).norm(), 0.99e-3F);
    EXPECT_LT((hair[1] - hair[0]).norm(), 1.2e-3F);
  }
}

TEST(BeamHairstyle, IsTheSameForAnyNumberOfWorkers) {
  const groom::TriangleMesh mesh = Dome(kCenter, 2, 15);
  const BeamHairstyle one = Make(mesh, 1), two = Make(mesh, 2);
  EXPECT_EQ(one.members.points, two.members.points);
  EXPECT_EQ(one.first_member, two.first_member);
  EXPECT_EQ(one.colours, two.colours);
}

TEST(BeamHairstyle, StopsWhenNobodyWaits) {
  exec::WorkerPool pool(1);
  beam::BeamStyle style = TwoParts();
  for (const bool is_cut : {true, false}) {
    if (!is_cut) style.parts[0].cuts.clear();
    const auto made = MakeBeamHairstyle(style, kGuides, Ball(), "style", pool, [] { return true; });
    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ErrorCode::kCancelled);
  }
}

// Whatever the fit of the guides: hairs at rest on them are where they were bent to.
TEST(BeamHairstyle, HairsOfTheGroomLieWhereTheyWereBentTo) {
  const BeamHairstyle made = Make(Ball());
  exec::WorkerPool pool(2);
  const auto import = groom::ImportStrands(made.guides, Options(), pool);
  ASSERT_TRUE(import);
  const groom::Hairs hairs = ToHairs(made.guides, made.first_member, made.members, made.colours,
                                     import->guides, import->rest);
  ASSERT_TRUE(groom::ValidateHairs(hairs, kGuides, {}));
  ASSERT_EQ(hairs.count(), 800U);
  size_t coordinate = 0, hair = 0;
  for (int g = 0; g < kGuides; ++g) {
    const groom::Guide& guide = import->guides[g];
    std::vector<Vector3d> theta(guide.strand.elements());
    for (Vector3d& angles : theta) {
      angles = Eigen::Map<const Vector3d>(&import->rest[coordinate]);
      coordinate += 3;
    }
    std::vector<Vector3f> samples(kGuideSamples);
    wire::SamplePoints(guide.root, guide.strand.length, theta, std::span(samples));
    std::vector<Eigen::Quaternionf> frames(kGuideSamples);
    wire::CarryFrames(guide.root.q.cast<float>(), samples, frames);
    for (; hair < made.first_member[g + 1]; ++hair) {
      ASSERT_EQ(hairs.guides[hair], static_cast<uint32_t>(g));
      const auto bent = made.members.strand(static_cast<int>(hair));
      std::vector<Vector3f> out(bent.size());
      wire::AssembleHair({samples, frames}, hairs.places_of(hair),
                         static_cast<float>(hairs.offset_unit), out);
      for (size_t k = 0; k < out.size(); ++k) {
        EXPECT_LT((out[k] - bent[k]).norm(), std::sqrt(0.75) * hairs.offset_unit + 5e-7);
        // Node k where node k of the guide is; those of the tail are uncut.
        if (bent.size() != 16) continue;
        EXPECT_NEAR(hairs.places_of(hair)[k].part, 65535.0 * static_cast<double>(k) / 15, 2);
      }
    }
  }
}

}  // namespace
}  // namespace mane::styling
