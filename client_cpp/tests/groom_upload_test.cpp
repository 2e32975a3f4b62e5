// Uploads arrive whole and in order, in messages below the server's limit of 1 MiB.

#include "groom_upload.h"

#include <gtest/gtest.h>

#include <cstring>
#include <vector>

namespace mane {
namespace {

constexpr size_t kServerLimit = 1 << 20;

std::vector<v1::CreateGroomRequest> Parts(const GroomUpload& upload) {
  std::vector<v1::CreateGroomRequest> parts;
  ForEachPart(upload, [&](const v1::CreateGroomRequest& part) {
    EXPECT_LT(part.ByteSizeLong(), kServerLimit);
    parts.push_back(part);
    return true;
  });
  return parts;
}

TEST(GroomUpload, SendsEveryGuideOnceInOrder) {
  Guide guide;
  guide.element_count = 256;
  guide.natural_twist.assign(256, 1.0);
  guide.natural_curvature_1.assign(256, 2.0);
  guide.natural_curvature_2.assign(256, 3.0);
  std::vector<Guide> guides(500, guide);
  for (size_t i = 0; i < guides.size(); ++i) guides[i].length_m = static_cast<double>(i);
  GroomUpload upload;
  upload.groom_id = "long";
  upload.guides = guides;

  const auto parts = Parts(upload);
  EXPECT_EQ(parts.front().header().groom_id(), "long");
  EXPECT_GT(parts.size(), 4u);
  double expected = 0;
  for (size_t i = 1; i < parts.size(); ++i) {
    for (const v1::Guide& sent : parts[i].guides().guides()) {
      EXPECT_EQ(sent.length_m(), expected++);
      EXPECT_EQ(sent.natural_curvature_2_size(), 256);
    }
  }
  EXPECT_EQ(expected, 500);
}

TEST(GroomUpload, CarriesEveryParameterOfAGuide) {
  Guide guide;
  guide.root_position = {1, 2, 3};
  guide.root_frame = {0.5, 0.5, 0.5, 0.5};
  guide.length_m = 0.3;
  guide.element_count = 2;
  guide.element_lengths_m = {0.1, 0.2};
  guide.radius_1_m = 4e-5;
  guide.radius_2_m = 5e-5;
  guide.young_modulus_pa = 1e9;
  guide.poisson_ratio = 0.48;
  guide.density_kg_m3 = 1300;
  guide.internal_friction = 5e-11;
  guide.air_drag = 5e-6;
  guide.natural_twist = {6};
  guide.natural_curvature_1 = {7, 8};
  guide.natural_curvature_2 = {9};
  guide.model = StrandModel::kWound;
  guide.wisp_radius_m = 0.01;
  GroomUpload upload;
  upload.guides = std::vector{guide};

  const auto parts = Parts(upload);
  ASSERT_EQ(parts.size(), 3u);
  EXPECT_TRUE(parts.back().has_commit());
  const v1::Guide& sent = parts[1].guides().guides(0);
  EXPECT_EQ(sent.root_position().z(), 3);
  EXPECT_EQ(sent.root_frame().w(), 0.5);
  EXPECT_EQ(sent.length_m(), 0.3);
  EXPECT_EQ(sent.element_count(), 2u);
  EXPECT_EQ(sent.element_lengths_m(1), 0.2);
  EXPECT_EQ(sent.radius_1_m(), 4e-5);
  EXPECT_EQ(sent.radius_2_m(), 5e-5);
  EXPECT_EQ(sent.young_modulus_pa(), 1e9);
  EXPECT_EQ(sent.poisson_ratio(), 0.48);
  EXPECT_EQ(sent.density_kg_m3(), 1300);
  EXPECT_EQ(sent.internal_friction(), 5e-11);
  EXPECT_EQ(sent.air_drag(), 5e-6);
  EXPECT_EQ(sent.natural_twist(0), 6);
  EXPECT_EQ(sent.natural_curvature_1(1), 8);
  EXPECT_EQ(sent.natural_curvature_2(0), 9);
  EXPECT_EQ(sent.model(), v1::STRAND_MODEL_WOUND);
  EXPECT_EQ(sent.wisp_radius_m(), 0.01);
}

TEST(GroomUpload, ConcatenatedMeshPiecesAreTheMesh) {
  TriangleMesh mesh;
  for (int i = 0; i < 300'000; ++i) mesh.vertices.push_back(static_cast<float>(i));
  for (std::uint32_t i = 0; i < 150'000; ++i) mesh.triangles.push_back(99'999 - i / 2);
  mesh.hair_triangles = {5, 7};
  GroomUpload upload;
  upload.scalp = mesh;
  upload.guides = GuideGeneration{
      .hair_type = HairType::kCaucasianWavy, .guide_count = 10, .model = StrandModel::kSuperHelix};

  std::string vertices, triangles, hair;
  const auto parts = Parts(upload);
  EXPECT_EQ(parts[0].header().generate().hair_type(), v1::HAIR_TYPE_CAUCASIAN_WAVY);
  EXPECT_EQ(parts[0].header().generate().model(), v1::STRAND_MODEL_SUPER_HELIX);
  EXPECT_FALSE(parts[0].header().has_ellipsoid());
  for (size_t i = 1; i < parts.size(); ++i) {
    vertices += parts[i].scalp_mesh().vertices();
    triangles += parts[i].scalp_mesh().triangles();
    hair += parts[i].scalp_mesh().hair_triangles();
  }
  ASSERT_EQ(vertices.size(), 4 * mesh.vertices.size());
  EXPECT_EQ(std::memcmp(vertices.data(), mesh.vertices.data(), vertices.size()), 0);
  ASSERT_EQ(triangles.size(), 4 * mesh.triangles.size());
  EXPECT_EQ(std::memcmp(triangles.data(), mesh.triangles.data(), triangles.size()), 0);
  EXPECT_EQ(hair.size(), 8u);
}

TEST(GroomUpload, SendsEveryStrandOnceInOrderWithItsOptions) {
  StrandImport import;
  import.options.hair_type = HairType::kCaucasianCurly;
  import.options.properties.density_kg_m3 = 1200;
  import.options.element_count = 30;
  import.options.error_bound_m = 2e-3;
  import.options.noise_m = 1e-4;
  import.options.hold = false;
  import.options.max_stiffness_factor = 7;
  import.options.stability_margin = 0.2;
  import.options.wisp_radius_m = 0.02;
  for (int i = 0; i < 200; ++i) {
    ImportedStrand strand;
    strand.points.assign(3000, static_cast<float>(i));
    import.strands.push_back(strand);
  }
  import.strands[7].root_frame = Quaternion{0.5, 0.5, 0.5, 0.5};
  import.strands[7].properties.radius_1_m = 4e-5;
  import.strands[7].properties.radius_2_m = 5e-5;
  import.strands[7].properties.young_modulus_pa = 3e9;
  import.strands[7].properties.poisson_ratio = 0.4;
  import.strands[7].properties.internal_friction = 1e-10;
  import.strands[7].properties.air_drag = 2e-5;
  GroomUpload upload;
  upload.guides = import;

  const auto parts = Parts(upload);
  const v1::ImportOptions& options = parts.front().header().import_options();
  EXPECT_EQ(options.hair_type(), v1::HAIR_TYPE_CAUCASIAN_CURLY);
  EXPECT_EQ(options.properties().density_kg_m3(), 1200);
  EXPECT_FALSE(options.properties().has_air_drag());
  EXPECT_EQ(options.element_count(), 30u);
  EXPECT_EQ(options.error_bound_m(), 2e-3);
  EXPECT_EQ(options.noise_m(), 1e-4);
  EXPECT_TRUE(options.has_hold() && !options.hold());
  EXPECT_EQ(options.max_stiffness_factor(), 7);
  EXPECT_EQ(options.stability_margin(), 0.2);
  EXPECT_EQ(options.wisp_radius_m(), 0.02);
  EXPECT_GT(parts.size(), 4u);
  EXPECT_TRUE(parts.back().has_commit());
  int expected = 0;
  for (size_t i = 1; i < parts.size(); ++i) {
    for (const v1::ImportedStrand& sent : parts[i].strands().strands()) {
      EXPECT_EQ(sent.points().size(), 12'000u);
      float first = -1;
      std::memcpy(&first, sent.points().data(), sizeof first);
      EXPECT_EQ(first, static_cast<float>(expected));
      EXPECT_EQ(sent.has_root_frame(), expected == 7);
      if (expected == 7) {
        EXPECT_EQ(sent.root_frame().w(), 0.5);
        EXPECT_EQ(sent.properties().radius_1_m(), 4e-5);
        EXPECT_EQ(sent.properties().radius_2_m(), 5e-5);
        EXPECT_EQ(sent.properties().young_modulus_pa(), 3e9);
        EXPECT_EQ(sent.properties().poisson_ratio(), 0.4);
        EXPECT_FALSE(sent.properties().has_density_kg_m3());
        EXPECT_EQ(sent.properties().internal_friction(), 1e-10);
        EXPECT_EQ(sent.properties().air_drag(), 2e-5);
      }
      ++expected;
    }
  }
  EXPECT_EQ(expected, 200);
}

TEST(GroomUpload, SendsEveryFieldOfABodyAndItsMeshInPieces) {
  TriangleMesh mesh;
  for (int i = 0; i < 300'000; ++i) mesh.vertices.push_back(static_cast<float>(i));
  for (std::uint32_t i = 0; i < 150'000; ++i) mesh.triangles.push_back(99'999 - i / 2);
  GroomUpload upload;
  upload.guides = std::vector<Guide>(1);
  upload.scalp_contact = ScalpContact{.material = Material::kSkin, .friction = 0.5};
  upload.bodies = {{.name = "ball", .shape = EllipsoidBody{{1, 2, 3}}, .friction_anisotropy = 0.1},
                   {.name = "arm",
                    .shape = CapsuleBody{{1, 0, 0}, {0, 1, 0}, 0.2},
                    .moving = true,
                    .pose = {{4, 5, 6}, {0, 1, 0, 0}}},
                   {.name = "coat", .shape = mesh, .material = Material::kWool}};

  const auto parts = Parts(upload);
  const v1::ScalpContact& scalp = parts[0].header().scalp_contact();
  EXPECT_EQ(scalp.material(), v1::MATERIAL_SKIN);
  EXPECT_EQ(scalp.friction(), 0.5);
  EXPECT_FALSE(scalp.has_friction_anisotropy());
  EXPECT_EQ(parts[1].body().name(), "ball");
  EXPECT_EQ(parts[1].body().ellipsoid().radii_m().z(), 3);
  EXPECT_EQ(parts[1].body().friction_anisotropy(), 0.1);
  EXPECT_FALSE(parts[1].body().has_friction());
  EXPECT_EQ(parts[2].body().capsule().b().y(), 1);
  EXPECT_EQ(parts[2].body().capsule().radius_m(), 0.2);
  EXPECT_TRUE(parts[2].body().moving());
  EXPECT_EQ(parts[2].body().pose().position().y(), 5);
  EXPECT_EQ(parts[2].body().pose().orientation().y(), 1);
  EXPECT_EQ(parts[3].body().material(), v1::MATERIAL_WOOL);
  std::string vertices, triangles;
  for (size_t i = 3; i + 2 < parts.size(); ++i) {
    EXPECT_EQ(parts[i].body().name(), "coat");
    EXPECT_TRUE(i == 3 || !parts[i].body().has_pose());
    EXPECT_EQ(parts[i].body().mesh().vertices().size() % 12, 0u);
    vertices += parts[i].body().mesh().vertices();
    triangles += parts[i].body().mesh().triangles();
  }
  ASSERT_EQ(vertices.size(), 4 * mesh.vertices.size());
  EXPECT_EQ(std::memcmp(vertices.data(), mesh.vertices.data(), vertices.size()), 0);
  ASSERT_EQ(triangles.size(), 4 * mesh.triangles.size());
  EXPECT_EQ(std::memcmp(triangles.data(), mesh.triangles.data(), triangles.size()), 0);
}

TEST(GroomUpload, StopsWhenTheStreamBreaks) {
  GroomUpload upload;
  upload.guides = std::vector<Guide>(10);
  int written = 0;
  ForEachPart(upload, [&](const v1::CreateGroomRequest&) { return ++written < 1; });
  EXPECT_EQ(written, 1);
}

TEST(GroomUpload, SendsWholeHairsInOrder) {
  GroomUpload upload;
  upload.hairs.offset_unit_m = 2e-6;
  for (std::uint32_t i = 0; i < 2000; ++i) {
    const std::uint16_t count = 2 + i % 999;
    upload.hairs.guides.push_back(i / 7);
    upload.hairs.point_counts.push_back(count);
    for (std::uint16_t k = 0; k < count; ++k) upload.hairs.places.push_back({k, {1, -2, 3}});
  }
  const auto parts = Parts(upload);
  EXPECT_EQ(parts.front().header().hair_offset_unit_m(), 2e-6);
  EXPECT_GT(parts.size(), 20u);
  std::string guides, places;
  for (const v1::CreateGroomRequest& part : parts) {
    const v1::HairBatch& batch = part.hairs();
    size_t points = 0;
    for (size_t i = 0; i < batch.guides().size() / 4; ++i) {
      points += upload.hairs.point_counts[guides.size() / 4 + i];
    }
    EXPECT_EQ(batch.places().size(), 8 * points);
    guides += batch.guides();
    places += batch.places();
  }
  EXPECT_EQ(guides.size(), 4u * 2000);
  ASSERT_EQ(places.size(), 8 * upload.hairs.places.size());
  EXPECT_EQ(std::memcmp(places.data(), upload.hairs.places.data(), places.size()), 0);
}

}  // namespace
}  // namespace mane
