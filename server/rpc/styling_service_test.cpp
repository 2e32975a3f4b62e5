// StylingService over a real server: a style becomes a groom whose hairs are where its members are;
// it survives a restart, is made once, is cancelled, and is refused by the name of what is wrong.

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <vector>

#include "mane/v1/style.grpc.pb.h"
#include "rpc/convert_style.h"
#include "rpc/style_presets.h"
#include "rpc/test_styling.h"
#include "styling/png_image.h"
#include "styling/stylist.h"

namespace mane::rpc {
namespace {

v1::ApplyStyleHeader SmallHeader() {
  v1::ApplyStyleHeader header;
  header.mutable_ellipsoid()->mutable_radii_m()->set_x(0.08);
  header.mutable_ellipsoid()->mutable_radii_m()->set_y(0.1);
  header.mutable_ellipsoid()->mutable_radii_m()->set_z(0.09);
  header.mutable_ellipsoid()->set_cap_angle(1.6);
  header.mutable_guides()->set_hair_type(v1::HAIR_TYPE_CAUCASIAN_WAVY);
  header.mutable_guides()->set_element_count(5);
  v1::Style* style = header.mutable_style();
  style->set_wisp_count(12);
  style->set_strand_count(60);
  style->mutable_length()->set_value(0.12);
  return header;
}

using StylingServiceTest = StylingFixture;

TEST_F(StylingServiceTest, AStyleBecomesAGroomAndSurvivesARestart) {
  auto header = SmallHeader();
  header.set_groom_id("styled");
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
  size_t members = 0, masters = 0, maps = 0, nodes = 0, vectors = 0, field_nodes = 0;
  for (const v1::HairstylePart& part : parts) {
    EXPECT_LT(part.ByteSizeLong(), 1U << 20);
    members += part.members().wisps().size() / 4;
    masters += part.masters().lengths().size() / 4;
    maps += part.has_map() ? 1 : 0;
    nodes += part.density().values().size() / 4;
    if (!part.has_field()) continue;
    const auto& field = part.field();
    field_nodes = size_t{field.nodes_x()} * field.nodes_y() * field.nodes_z();
    for (size_t at = 0; at < field.values().size(); at += 12, ++vectors) {
      float v[3];
      std::memcpy(v, field.values().data() + at, sizeof(v));
      EXPECT_EQ(v[1], -1);  // Gravity of strength 1.
    }
  }
  EXPECT_EQ(members, 60U);
  EXPECT_EQ(masters, 12U);
  EXPECT_EQ(maps, 3U);
  EXPECT_GT(nodes, 1000U);
  EXPECT_GT(vectors, 1000U);
  EXPECT_EQ(vectors, field_nodes);
  ASSERT_TRUE(parts.back().has_report());
  EXPECT_EQ(parts.back().report().groom(), "grooms/styled");
  EXPECT_EQ(parts.back().report().strand_count(), 60U);

  ExpectGroom("grooms/styled", 12, 60);
}

TEST_F(StylingServiceTest, TheSameRequestIsOneJob) {
  auto header = SmallHeader();
  ExpectOneJob(header);
  v1::Job second;
  header.set_groom_id("once");
  header.set_request_id("twice");
  const grpc::Status taken = Apply(header, &second);
  EXPECT_EQ(taken.error_code(), grpc::StatusCode::ALREADY_EXISTS);
  EXPECT_EQ(NamedField(taken), "header.groom_id");
}

// Segments are as short as a pattern needs where the style does not say.
TEST_F(StylingServiceTest, EveryShippedPatternGrowsByDefault) {
  for (int kind = v1::STRAND_KIND_STRAIGHT; kind <= v1::STRAND_KIND_KINKY; ++kind) {
    v1::Style message;
    message.mutable_synthesis()->mutable_prototype()->set_kind(static_cast<v1::StrandKind>(kind));
    const auto style = ToStyle(message, "style");
    ASSERT_TRUE(style) << style.error().message;
    EXPECT_GE(style->segment_length, 1e-3);
    EXPECT_LE(style->segment_length, 0.01);
  }
}

TEST_F(StylingServiceTest, AJobStopsWithinASecond) {
  auto header = SmallHeader();
  header.mutable_style()->set_wisp_count(2000);
  v1::Job job;
  ASSERT_TRUE(Apply(header, &job).ok());
  const auto stub = v1::JobService::NewStub(server_.channel());
  v1::CancelJobRequest request;
  request.set_name(job.name());
  grpc::ClientContext context;
  ASSERT_TRUE(stub->CancelJob(&context, request, &job).ok());
  EXPECT_EQ(Watch(job.name()).state(), v1::Job::STATE_CANCELLED);
  grpc::Status status;
  Read(job.name(), &status);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(NamedField(status), "name");
}

TEST_F(StylingServiceTest, WhatIsWrongIsNamed) {
  const auto field = [&](const auto& change) {
    auto header = SmallHeader();
    change(&header);
    v1::Job job;
    const grpc::Status status = Apply(header, &job);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
    return NamedField(status);
  };
  using Header = v1::ApplyStyleHeader*;
  EXPECT_EQ(field([](Header h) { h->clear_ellipsoid(); }), "scalp_mesh");
  EXPECT_EQ(field([](Header h) { h->clear_guides(); }), "header.guides.hair_type");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->set_wisp_count(0); }),
            "header.style.wisp_count");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->set_strand_count(2'000'000); }),
            "header.style.strand_count");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->set_fuzziness(2); }),
            "header.style.fuzziness");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->set_bending_stiffness(-1); }),
            "header.style.bending_stiffness");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->set_density_threshold(0); }),
            "header.style.density_threshold");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->add_radii_m(-1); }),
            "header.style.radii_m[0]");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->mutable_density()->set_png("no png"); }),
            "header.style.density.png");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->add_field(); }), "header.style.field[0].kind");
  EXPECT_EQ(field([](Header h) {
              auto* prototype = h->mutable_style()->mutable_synthesis()->mutable_prototype();
              prototype->set_points("123");
            }),
            "header.style.synthesis.prototype.points");
  EXPECT_EQ(field([](Header h) {
              h->mutable_style()->mutable_member_length()->mutable_uniform()->set_high(9);
            }),
            "header.style.member_length.uniform.high");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->add_operations(); }),
            "header.style.operations[0]");
  EXPECT_EQ(field([](Header h) {
              auto* tie = h->mutable_style()->add_operations()->mutable_tie();
              tie->mutable_point()->set_y(0.2);
            }),
            "header.style.operations[0].tie.radius_m");
  EXPECT_EQ(field([](Header h) { h->mutable_style()->add_queues(); }),
            "header.style.queues[0].constraints");
}

// A few kilobytes that hold millions of pixels each.
TEST_F(StylingServiceTest, ImagesOfAStyleHaveABudget) {
  auto header = SmallHeader();
  std::vector<float> values(size_t{4096} * 4096, 1.0F);
  for (int i = 0; i < 3; ++i) {
    values[0] = static_cast<float>(i) / 4;  // Equal ones count once.
    auto* regional = header.mutable_style()->add_regional();
    regional->mutable_region()->set_mask_png(styling::EncodePng({4096, 4096, values}));
  }
  v1::Job job;
  const grpc::Status status = Apply(header, &job);
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_EQ(NamedField(status), "header.style.regional[2].region.mask_png");
}

// What shows only when the style is applied fails the job, which says so.
TEST_F(StylingServiceTest, WhatDoesNotFitTheHeadFailsTheJob) {
  auto header = SmallHeader();
  header.mutable_style()->mutable_length()->set_value(0);
  v1::Job job;
  ASSERT_TRUE(Apply(header, &job).ok());
  const v1::Job failed = Watch(job.name());
  EXPECT_EQ(failed.state(), v1::Job::STATE_FAILED);
  EXPECT_NE(failed.error().find("header.style.length"), std::string::npos);
}

// Of a head of human size: every preset is valid, leads all hair that it selects, and keeps out.
TEST(StylePresetsTest, EveryPresetComesOut) {
  int wisps = 0;
  groom::Ellipsoid head;
  head.center = {0, 0.05, 0.02};
  head.radii = {0.077, 0.094, 0.092};
  head.cap_angle = 1.75;
  const styling::Obstacles obstacles{
      {contact::Ellipsoid{head.radii}, {head.center, Eigen::Quaterniond::Identity()}}};
  exec::WorkerPool pool(2);
  styling::Stylist stylist(head, obstacles);
  for (const v1::StylePreset& preset : StylePresets().presets()) {
    if (!preset.has_style()) continue;
    ++wisps;
    SCOPED_TRACE(preset.name());
    v1::Style small = preset.style();
    small.set_wisp_count(150);
    small.set_strand_count(300);
    const auto style = ToStyle(small, "style");
    ASSERT_TRUE(style) << style.error().message;
    const auto made = stylist.Apply(*style, "style", pool);
    ASSERT_TRUE(made) << made.error().message;
    for (size_t k = 0; k < style->queues.size(); ++k) {
      // Hair is gathered at a queue's first point. Short hair may end within a braid or bun.
      if (style->queues[k].constraints[0].kind != styling::Constraint::Kind::kPoint) continue;
      EXPECT_EQ((*made)->solved.constraints[k][0].missed, 0) << style->queues[k].name;
    }
    for (const Eigen::Vector3f& p : (*made)->masters.points) {
      ASSERT_GT(styling::DistanceTo(obstacles, p.cast<double>()).distance, -1e-5);
    }
  }
  EXPECT_EQ(wisps, 7);
}

}  // namespace
}  // namespace mane::rpc
