// Grooms through the client and the real daemon: stored, described, generated, at rest.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "daemon.h"
#include "test_hair.h"

namespace mane::client_test {
namespace {

// An octahedron of 10 cm about the origin, hair on its upper half.
TriangleMesh Octahedron() {
  TriangleMesh mesh;
  mesh.vertices = {0.1f, 0, 0, -0.1f, 0, 0, 0, 0.1f, 0, 0, -0.1f, 0, 0, 0, 0.1f, 0, 0, -0.1f};
  mesh.triangles = {0, 2, 4, 4, 2, 1, 1, 2, 5, 5, 2, 0, 4, 3, 0, 1, 3, 4, 5, 3, 1, 0, 3, 5};
  mesh.hair_triangles = {0, 1, 2, 3};
  return mesh;
}

TEST(E2eGrooms, ACreatedGroomIsDescribedListedAndDeleted) {
  Daemon daemon;
  Client client = daemon.Connect();
  GroomUpload upload = WavyGroom(12);
  upload.groom_id = "wavy-twelve";
  upload.display_name = "Twelve";
  const auto created = client.CreateGroom(upload);
  ASSERT_TRUE(created) << created.error().message;
  EXPECT_EQ(created->name, "grooms/wavy-twelve");
  EXPECT_EQ(created->guide_count, 12u);
  EXPECT_EQ(created->element_count, 3u * (3 + 4 + 5 + 6));
  EXPECT_NEAR(created->longest_guide_m, 0.19, 1e-12);
  EXPECT_EQ(created->hair_type, HairType::kUnspecified);
  EXPECT_FALSE(created->has_scalp);

  const auto got = client.GetGroom(created->name);
  ASSERT_TRUE(got);
  EXPECT_EQ(got->etag, created->etag);
  EXPECT_EQ(got->display_name, "Twelve");
  EXPECT_GT(got->create_time_s, 1.6e9);

  const auto listed = client.ListGrooms();
  ASSERT_TRUE(listed);
  ASSERT_EQ(listed->size(), 1u);
  EXPECT_EQ(listed->front().name, created->name);

  ASSERT_TRUE(client.DeleteGroom(created->name));
  EXPECT_EQ(client.GetGroom(created->name).error().code, ErrorCode::kNotFound);
  EXPECT_EQ(client.DeleteGroom(created->name).error().code, ErrorCode::kNotFound);
  EXPECT_TRUE(client.ListGrooms()->empty());
}

TEST(E2eGrooms, TheSameRequestIdMakesOneGroom) {
  Daemon daemon;
  Client client = daemon.Connect();
  GroomUpload upload = WavyGroom(2);
  upload.request_id = "0f6b6c3e-once";
  const std::string first = Create(client, upload), second = Create(client, upload);
  EXPECT_EQ(first, second);
  EXPECT_EQ(client.ListGrooms()->size(), 1u);
}

TEST(E2eGrooms, AnAnsweredGroomSurvivesKill9) {
  Daemon daemon;
  std::string name, etag;
  {
    Client client = daemon.Connect();
    name = Create(client, WavyGroom(7));
    etag = client.GetGroom(name)->etag;
  }
  daemon.Kill();
  daemon.Start();
  const auto groom = daemon.Connect().GetGroom(name);
  ASSERT_TRUE(groom);
  EXPECT_EQ(groom->etag, etag);
}

TEST(E2eGrooms, EveryHairTypeGrowsOnEitherScalpAndFromItsSeed) {
  Daemon daemon;
  Client client = daemon.Connect();
  for (const HairType type : {HairType::kAsianSmooth, HairType::kCaucasianWavy,
                              HairType::kCaucasianCurly, HairType::kAfricanFuzzy}) {
    SCOPED_TRACE(static_cast<int>(type));
    GroomUpload upload;
    upload.guides =
        GuideGeneration{.hair_type = type, .guide_count = 20, .length_m = 0.15, .seed = 7};
    upload.scalp = EllipsoidScalp{.radii_m = {0.08, 0.11, 0.09}, .cap_angle = 1.4};
    const auto ellipsoid = client.CreateGroom(upload);
    ASSERT_TRUE(ellipsoid) << ellipsoid.error().message;
    EXPECT_EQ(ellipsoid->guide_count, 20u);
    EXPECT_EQ(ellipsoid->hair_type, type);
    EXPECT_EQ(ellipsoid->seed, 7u);
    EXPECT_TRUE(ellipsoid->has_scalp);
    EXPECT_EQ(client.CreateGroom(upload)->etag, ellipsoid->etag);

    std::get<GuideGeneration>(upload.guides).seed = 8;
    EXPECT_NE(client.CreateGroom(upload)->etag, ellipsoid->etag);

    upload.scalp = Octahedron();
    const auto mesh = client.CreateGroom(upload);
    ASSERT_TRUE(mesh) << mesh.error().message;
    EXPECT_EQ(mesh->guide_count, 20u);
  }
}

TEST(E2eGrooms, AGroomLargerThanOneMessageArrivesWhole) {
  Daemon daemon;
  Client client = daemon.Connect();
  std::vector<Guide> guides(2500, WavyGuide());
  for (Guide& guide : guides) {
    guide.element_count = 16;
    guide.natural_twist.assign(16, 20.0);
    guide.natural_curvature_1.assign(16, 50.0);
    guide.natural_curvature_2.assign(16, 1.0);
  }
  GroomUpload upload;
  upload.guides = guides;  // About 1.3 MB; the daemon takes messages of 1 MiB.
  const auto groom = client.CreateGroom(upload);
  ASSERT_TRUE(groom) << groom.error().message;
  EXPECT_EQ(groom->guide_count, 2500u);
  EXPECT_EQ(groom->element_count, 2500u * 16);
}

TEST(E2eGrooms, AtRestAStrandHangsFromItsRoot) {
  Daemon daemon;
  Client client = daemon.Connect();
  Guide guide = WavyGuide();
  guide.natural_twist = {};
  guide.natural_curvature_1 = {};
  GroomUpload upload;
  upload.guides = std::vector{guide, WavyGuide()};
  const std::string name = Create(client, upload);
  const auto rest = client.ComputeRestShape(name, {.points_per_guide = 9});
  ASSERT_TRUE(rest) << rest.error().message;
  EXPECT_EQ(rest->points_per_guide, 9u);
  ASSERT_EQ(rest->positions.size(), 2u * 9 * 3);
  ASSERT_EQ(rest->curvatures.size(), 10u * 3);
  ASSERT_EQ(rest->residuals.size(), 2u);
  for (const double residual : rest->residuals) EXPECT_LE(residual, 1e-6);
  EXPECT_NEAR(rest->positions[0], 0.08, 1e-12);
  EXPECT_NEAR(rest->positions[1], 0.1, 1e-12);
  // A smooth 20 cm hair cannot hold itself up sideways: most of it ends below its root.
  EXPECT_LT(rest->positions[8 * 3 + 1], 0.1 - 0.1);
  EXPECT_NEAR(rest->positions[8 * 3 + 2], 0, 1e-9) << "a plane strand stays in its plane";

  const auto weightless = client.ComputeRestShape(name, {.gravity = {}, .points_per_guide = 9});
  ASSERT_TRUE(weightless);
  EXPECT_NEAR(weightless->positions[8 * 3], 0.08 + 0.2, 1e-9) << "the natural shape is straight";
  EXPECT_NEAR(weightless->curvatures[5 * 3 + 1], 60, 1e-6) << "the natural shape is wavy";
}

TEST(E2eGrooms, ImportedStrandsRestInTheirShape) {
  Daemon daemon;
  Client client = daemon.Connect();
  // Hair that leaves the head sideways and falls, 40 points each.
  StrandImport import;
  import.options.hair_type = HairType::kCaucasianWavy;
  for (int i = 0; i < 3; ++i) {
    ImportedStrand strand;
    for (int k = 0; k < 40; ++k) {
      const double t = k / 39.0;
      strand.points.push_back(static_cast<float>(0.1 + 0.04 * std::sin(2 * t)));
      strand.points.push_back(static_cast<float>(0.01 * t - 0.15 * t * t));
      strand.points.push_back(static_cast<float>(0.01 * i * (1 + std::cos(6 * t))));
    }
    import.strands.push_back(strand);
  }
  GroomUpload upload;
  upload.guides = import;
  const auto created = client.CreateGroom(upload);
  ASSERT_TRUE(created) << created.error().message;
  ASSERT_TRUE(created->import_summary);
  EXPECT_EQ(created->import_summary->strand_count, 3u);
  EXPECT_EQ(created->import_summary->point_count, 120u);
  EXPECT_EQ(created->import_summary->not_held_count, 0u);
  EXPECT_LE(created->import_summary->largest_fit_distance_m, import.options.error_bound_m);

  const auto report = client.GetImportReport(created->name);
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_EQ(report->held, (std::vector<std::uint8_t>{1, 1, 1}));
  EXPECT_EQ(report->bounds_met, (std::vector<std::uint8_t>{1, 1, 1}));
  EXPECT_EQ(*std::ranges::max_element(report->largest_fit_distances),
            static_cast<float>(created->import_summary->largest_fit_distance_m));
  EXPECT_EQ(report->element_counts[0] + report->element_counts[1] + report->element_counts[2],
            created->element_count);

  const auto rest = client.ComputeRestShape(created->name, {.points_per_guide = 2});
  ASSERT_TRUE(rest);
  for (size_t i = 0; i < 3; ++i) {
    for (size_t x = 0; x < 3; ++x) {  // The last point.
      EXPECT_NEAR(rest->positions[6 * i + 3 + x], import.strands[i].points[117 + x], 1e-3);
    }
  }

  import.strands[1].points[4] = std::nanf("");
  upload.guides = import;
  const auto refused = client.CreateGroom(upload);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().field, "strands[1].points[1].y");
  const auto plain = client.GetImportReport(Create(client, WavyGroom(1)));
  ASSERT_FALSE(plain);
  EXPECT_EQ(plain.error().code, ErrorCode::kFailedPrecondition);
}

}  // namespace
}  // namespace mane::client_test
