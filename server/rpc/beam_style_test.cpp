// Styles by beams over a real server: one becomes a groom whose guides are some of its hairs; it
// survives a restart, is made once, is cancelled, and is refused by the name of what is wrong.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "beam/presets.h"
#include "rpc/convert_beam_style.h"
#include "rpc/style_admission.h"
#include "rpc/style_presets.h"
#include "rpc/test_styling.h"
#include "styling/beam_hairstyle.h"

namespace mane::rpc {
namespace {

using BeamStyleTest = StylingFixture;

v1::ApplyStyleHeader SmallHeader() {
  v1::ApplyStyleHeader header;
  header.mutable_ellipsoid()->mutable_radii_m()->set_x(0.08);
  header.mutable_ellipsoid()->mutable_radii_m()->set_y(0.1);
  header.mutable_ellipsoid()->mutable_radii_m()->set_z(0.09);
  header.mutable_guides()->set_hair_type(v1::HAIR_TYPE_CAUCASIAN_WAVY);
  header.mutable_guides()->set_element_count(5);
  v1::BeamStyle* style = header.mutable_beam_style();
  style->set_guide_count(12);
  v1::BeamPart* part = style->add_parts();
  part->set_name("all");
  part->set_hair_count(60);
  part->set_segment_count(8);
  part->set_length_m(0.12);
  part->mutable_pores()->mutable_zenith()->set_high(1.4);
  return header;
}

TEST_F(BeamStyleTest, AStyleBecomesAGroomAndSurvivesARestart) {
  auto header = SmallHeader();
  header.set_groom_id("beams");
  v1::Job job;
  ASSERT_TRUE(Apply(header, &job).ok());
  EXPECT_EQ(job.kind(), "style");
  const v1::Job done = Watch(job.name());
  ASSERT_EQ(done.state(), v1::Job::STATE_SUCCEEDED) << done.error();
  EXPECT_EQ(done.progress(), 1);
  server_.Restart();

  grpc::Status status;
  const auto parts = Read(job.name(), &status);
  ASSERT_TRUE(status.ok());
  size_t members = 0, points = 0;
  for (const v1::HairstylePart& part : parts) {
    members += part.members().wisps().size() / 4;
    points += part.members().points().size() / 12;
    EXPECT_EQ(part.members().colours().size() / 3, part.members().wisps().size() / 4);
    for (size_t at = 0; at < part.masters().lengths().size(); at += 4) {
      float length;
      uint32_t joints;
      std::memcpy(&length, part.masters().lengths().data() + at, sizeof(length));
      std::memcpy(&joints, part.masters().joint_counts().data() + at, sizeof(joints));
      EXPECT_NEAR(length, 0.12F, 1e-5);
      EXPECT_EQ(joints, 9U);
    }
  }
  EXPECT_EQ(members, 60U);
  EXPECT_EQ(points, 60U * 9);
  ASSERT_TRUE(parts.back().has_report());
  const v1::StyleReport& report = parts.back().report();
  EXPECT_EQ(report.groom(), "grooms/beams");
  EXPECT_EQ(report.wisp_count(), 12U);
  EXPECT_EQ(report.strand_count(), 60U);
  EXPECT_EQ(report.control_point_count(), points);

  ExpectGroom("grooms/beams", 12, 60);
}

TEST_F(BeamStyleTest, TheSameRequestIsOneJob) { ExpectOneJob(SmallHeader()); }

TEST_F(BeamStyleTest, AJobStopsWithinASecond) {
  auto header = SmallHeader();
  header.mutable_beam_style()->set_guide_count(2000);
  header.mutable_beam_style()->mutable_parts(0)->set_hair_count(200'000);
  v1::Job job;
  ASSERT_TRUE(Apply(header, &job).ok());
  const auto stub = v1::JobService::NewStub(server_.channel());
  v1::CancelJobRequest request;
  request.set_name(job.name());
  grpc::ClientContext context;
  ASSERT_TRUE(stub->CancelJob(&context, request, &job).ok());
  EXPECT_EQ(Watch(job.name()).state(), v1::Job::STATE_CANCELLED);
}

TEST_F(BeamStyleTest, WhatIsWrongIsNamed) {
  const auto field = [&](const auto& change,
                         grpc::StatusCode code = grpc::StatusCode::INVALID_ARGUMENT) {
    auto header = SmallHeader();
    change(&header);
    v1::Job job;
    const grpc::Status status = Apply(header, &job);
    EXPECT_EQ(status.error_code(), code) << status.error_message();
    return NamedField(status);
  };
  using Header = v1::ApplyStyleHeader*;
  EXPECT_EQ(field([](Header h) { h->mutable_style(); }), "header.beam_style");
  EXPECT_EQ(field([](Header h) { h->mutable_beam_style()->clear_parts(); }),
            "header.beam_style.parts");
  EXPECT_EQ(field([](Header h) { h->mutable_beam_style()->mutable_parts(0)->add_cuts(); }),
            "header.beam_style.parts[0].cuts[0].height_m");
  EXPECT_EQ(field(
                [](Header h) {
                  h->mutable_beam_style()->set_guide_count(20'000);
                  h->mutable_beam_style()->mutable_parts(0)->set_hair_count(200'000);
                  h->mutable_guides()->set_element_count(64);
                },
                grpc::StatusCode::RESOURCE_EXHAUSTED),
            "header.beam_style.guide_count");
}

TEST(BeamStyleAdmission, WhatAGroomMayNotHoldIsNamed) {
  BeamDocument document;
  document.style.parts.resize(2);
  document.style.parts[0].count = 100;
  document.style.parts[1].count = 50;
  document.guide_count = 20;
  groom::ImportOptions guides;
  guides.hair_type = groom::HairType::kCaucasianWavy;
  const auto field = [&](auto groom::Limits::*limit, auto least) {
    groom::Limits limits;
    limits.*limit = least;
    EXPECT_TRUE(AdmitBeamStyle(document, guides, limits));
    limits.*limit = least - 1;
    const auto refused = AdmitBeamStyle(document, guides, limits);
    EXPECT_FALSE(refused);
    EXPECT_EQ(refused.error().code, ErrorCode::kResourceExhausted);
    return refused.error().field;
  };
  EXPECT_EQ(field(&groom::Limits::max_hairs, 150), "header.beam_style.parts");
  EXPECT_EQ(field(&groom::Limits::max_hair_points, 150 * 22), "header.beam_style.parts");
  EXPECT_EQ(field(&groom::Limits::max_guides, 20), "header.beam_style.guide_count");
  document.guide_count = 1;  // Each part has one.
  EXPECT_EQ(field(&groom::Limits::max_guides, 2), "header.beam_style.parts");
}

// What shows only when the style is applied fails the job, which says so.
TEST_F(BeamStyleTest, WhatDoesNotFitTheHeadFailsTheJob) {
  auto header = SmallHeader();
  header.mutable_beam_style()->mutable_parts(0)->mutable_tied_at()->set_y(0.05);
  v1::Job job;
  ASSERT_TRUE(Apply(header, &job).ok());
  const v1::Job failed = Watch(job.name());
  EXPECT_EQ(failed.state(), v1::Job::STATE_FAILED);
  EXPECT_NE(failed.error().find("header.beam_style.parts[0].tied_at"), std::string::npos)
      << failed.error();
}

// Of a head of human size: every preset is valid, and hair grows from it all.
TEST(BeamPresetsTest, EveryPresetComesOut) {
  groom::Ellipsoid head;
  head.center = {0, 0.055, 0.025};
  head.radii = {0.09, 0.112, 0.115};
  exec::WorkerPool pool(2);
  int presets = 0;
  for (const v1::StylePreset& preset : StylePresets().presets()) {
    if (!preset.has_beam_style()) continue;
    ++presets;
    SCOPED_TRACE(preset.name());
    EXPECT_TRUE(preset.name().starts_with("beam-"));
    const auto style = ToBeamStyle(preset.beam_style(), "style");
    ASSERT_TRUE(style) << style.error().message;
    const auto made = styling::MakeBeamHairstyle(style->style, 50, head, "style", pool);
    ASSERT_TRUE(made) << made.error().message;
    int hairs = 0;
    for (const beam::Part& part : style->style.parts) hairs += part.count;
    EXPECT_GT(made->members.strands(), 0.9 * hairs);
    const beam::Hull hull{head.center, head.radii};
    for (const Eigen::Vector3f& p : made->members.points) {
      ASSERT_GT(hull.At(p.cast<double>()), -1e-5);
    }
  }
  EXPECT_EQ(presets, 5);
}

// Planes go along with the head.
TEST(BeamPresetsTest, HairIsSweptBackAsFarAsTheSamePlaces) {
  const auto& presets = StylePresets().presets();
  const auto moved = std::ranges::find(presets, "beam-swept-back", &v1::StylePreset::name);
  const auto own = beam::BeamPresets();
  const auto before = std::ranges::find(own, "swept_back", &beam::BeamPreset::name);
  ASSERT_TRUE(moved != presets.end() && before != own.end());
  const beam::Hull from = beam::PresetHull();
  const auto& forces = before->style.parts[0].forces;
  for (int i = 0; i < static_cast<int>(forces.size()); ++i) {
    const double z = forces[i].where.at(0).offset;
    const auto& plane = moved->beam_style().parts(0).forces(i).where(0);
    EXPECT_EQ(plane.normal().z(), 1);
    EXPECT_NEAR(plane.offset_m(), (z - from.center.z()) / from.radii.z() * 0.117 + 0.025, 1e-4);
  }
}

// Cuts of the ponytail's moved preset meet where its hair is tied.
TEST(BeamPresetsTest, HairOfThePonytailEndsAtItsTie) {
  const auto& presets = StylePresets().presets();
  const auto tail = std::ranges::find(presets, "beam-ponytail", &v1::StylePreset::name);
  ASSERT_NE(tail, presets.end());
  auto document = *ToBeamStyle(tail->beam_style(), "style");
  const Eigen::Vector3d tie = *document.style.parts.back().tied_at;
  const beam::Hull hull{{0, 0.055, 0.025}, {0.092, 0.113, 0.117}};
  EXPECT_GT(hull.At(tie), 0);
  EXPECT_LT(hull.At(tie), 0.15);
  document.style.parts.pop_back();
  const auto loop = [](int count, const auto& work) { work(0, count); };
  const auto hairs = beam::ApplyBeamStyle(document.style, hull, "style", loop);
  ASSERT_TRUE(hairs);
  int at_tie = 0;
  for (int hair = 0; hair < hairs->count(); ++hair) {
    const Eigen::Vector3d tip = hairs->nodes[hairs->first_node[hair + 1] - 1].cast<double>();
    at_tie += (tip - tie).norm() < 0.04 ? 1 : 0;
  }
  EXPECT_GT(at_tie, 0.6 * hairs->count());
}

}  // namespace
}  // namespace mane::rpc
