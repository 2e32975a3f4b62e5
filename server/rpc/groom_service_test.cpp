// GroomService, BakeService and JobService against a real server over loopback.

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>
#include <span>

#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class GroomServiceTest : public ::testing::Test {
 protected:
  std::unique_ptr<v1::GroomService::Stub> stub() {
    return v1::GroomService::NewStub(server_.channel());
  }
  size_t GroomCount() {
    grpc::ClientContext context;
    v1::ListGroomsResponse response;
    EXPECT_TRUE(stub()->ListGrooms(&context, {}, &response).ok());
    return static_cast<size_t>(response.grooms_size());
  }

  TestServer server_;
};

TEST_F(GroomServiceTest, EveryBadGuideIsRefusedAndNothingIsStored) {
  struct Case {
    const char* field;
    std::function<void(v1::Guide*)> spoil;
  };
  const std::vector<Case> cases = {
      {"guides[1].length_m", [](auto* g) { g->set_length_m(0); }},
      {"guides[1].length_m", [](auto* g) { g->set_length_m(-0.1); }},
      {"guides[1].length_m", [](auto* g) { g->set_length_m(kNan); }},
      {"guides[1].element_count", [](auto* g) { g->set_element_count(0); }},
      {"guides[1].element_count", [](auto* g) { g->set_element_count(4'000'000'000); }},
      {"guides[1].radius_1_m", [](auto* g) { g->set_radius_1_m(0); }},
      {"guides[1].radius_2_m", [](auto* g) { g->set_radius_2_m(-1e-5); }},
      {"guides[1].young_modulus_pa", [](auto* g) { g->set_young_modulus_pa(kNan); }},
      {"guides[1].density_kg_m3", [](auto* g) { g->set_density_kg_m3(0); }},
      {"guides[1].internal_friction", [](auto* g) { g->set_internal_friction(-1); }},
      {"guides[1].air_drag", [](auto* g) { g->set_air_drag(kNan); }},
      {"guides[1].root_frame", [](auto* g) { g->mutable_root_frame()->set_w(1.5); }},
      {"guides[1].natural_curvature_1", [](auto* g) { g->add_natural_curvature_1(1); }},
  };
  for (const Case& bad : cases) {
    v1::Guide guide = GoodGuide();
    bad.spoil(&guide);
    v1::Groom groom;
    const grpc::Status status = server_.Upload(UploadOf({GoodGuide(), guide}), &groom);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.field;
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
  }
  EXPECT_EQ(GroomCount(), 0u);
}

TEST_F(GroomServiceTest, EmptyAndMisshapenUploadsAreRefused) {
  v1::Groom groom;
  EXPECT_EQ(NamedField(server_.Upload({}, &groom)), "header");
  EXPECT_EQ(NamedField(server_.Upload(UploadOf({}), &groom)), "guides");
  auto twice = UploadOf({GoodGuide()});
  twice.push_back(twice.front());
  EXPECT_EQ(NamedField(server_.Upload(twice, &groom)), "header");
  auto mesh = UploadOf({GoodGuide()});
  mesh.emplace_back().mutable_scalp_mesh()->set_vertices("1234567");
  EXPECT_EQ(NamedField(server_.Upload(mesh, &groom)), "scalp_mesh.vertices");
  auto id = UploadOf({GoodGuide()});
  id[0].mutable_header()->set_groom_id("Not/An/Id");
  EXPECT_EQ(NamedField(server_.Upload(id, &groom)), "header.groom_id");
  EXPECT_EQ(GroomCount(), 0u);
}

TEST_F(GroomServiceTest, AnUploadThatEndsWithoutCommitStoresNothing) {
  for (const bool cancel : {true, false}) {
    grpc::ClientContext context;
    v1::Groom groom;
    const auto writer = stub()->CreateGroom(&context, &groom);
    for (const auto& message : UploadOf({GoodGuide()})) ASSERT_TRUE(writer->Write(message));
    if (cancel) {
      context.TryCancel();
    } else {
      writer->WritesDone();
    }
    const grpc::Status status = writer->Finish();
    EXPECT_FALSE(status.ok());
    if (!cancel) {
      EXPECT_EQ(NamedField(status), "commit");
    }
  }
  EXPECT_EQ(GroomCount(), 0u);
}

TEST_F(GroomServiceTest, AnExportUploadsToAnEqualGroomAndSurvivesARestart) {
  auto messages = UploadOf({GoodGuide(3), GoodGuide(6)});
  messages[0].mutable_header()->set_groom_id("first");
  messages[0].mutable_header()->set_request_id("request-1");
  v1::EllipsoidScalp* scalp = messages[0].mutable_header()->mutable_ellipsoid();
  for (auto set : {&v1::Vector3::set_x, &v1::Vector3::set_y, &v1::Vector3::set_z}) {
    (scalp->mutable_radii_m()->*set)(0.1);
  }
  v1::Groom first;
  ASSERT_TRUE(server_.Upload(messages, &first).ok());
  EXPECT_EQ(first.name(), "grooms/first");
  EXPECT_EQ(first.guide_count(), 2u);
  EXPECT_EQ(first.element_count(), 9u);
  server_.Restart();

  grpc::ClientContext context;
  v1::ExportGroomRequest request;
  request.set_name(first.name());
  const auto reader = stub()->ExportGroom(&context, request);
  std::vector<v1::CreateGroomRequest> copy(1);
  copy[0].mutable_header()->set_display_name("test");
  v1::ExportGroomResponse part;
  while (reader->Read(&part)) {
    if (part.has_ellipsoid()) *copy[0].mutable_header()->mutable_ellipsoid() = part.ellipsoid();
    if (part.has_guides()) *copy.emplace_back().mutable_guides() = part.guides();
  }
  ASSERT_TRUE(reader->Finish().ok());
  v1::Groom second, again;
  ASSERT_TRUE(server_.Upload(copy, &second).ok());
  EXPECT_EQ(second.etag(), first.etag());
  EXPECT_NE(second.name(), first.name());

  ASSERT_TRUE(server_.Upload(messages, &again).ok());  // The request_id is remembered.
  EXPECT_EQ(again.name(), first.name());
  messages[0].mutable_header()->set_request_id("request-2");
  v1::Body* open = messages.emplace_back().mutable_body();  // Bounds nothing; comes to be looked at
  open->set_name("open");                                   // after the name only.
  open->mutable_mesh()->set_vertices(std::string(36, '\0'));
  open->mutable_mesh()->set_triangles(std::string(12, '\0'));
  const grpc::Status taken = server_.Upload(messages, &again);
  EXPECT_EQ(taken.error_code(), grpc::StatusCode::ALREADY_EXISTS) << taken.error_message();
  EXPECT_EQ(NamedField(taken), "header.groom_id");
  EXPECT_EQ(GroomCount(), 2u);
}

TEST_F(GroomServiceTest, RestShapeHangsDownAndKeepsItsLength) {
  const std::string name = server_.MakeGroom(6);
  grpc::ClientContext context;
  v1::ComputeRestShapeRequest request;
  request.set_name(name);
  request.set_points_per_guide(20);
  v1::ComputeRestShapeResponse response;
  ASSERT_TRUE(stub()->ComputeRestShape(&context, request, &response).ok());
  ASSERT_EQ(response.positions().size(), 3u * 20 * 3 * sizeof(double));
  std::vector<double> p(3 * 20 * 3);
  std::memcpy(p.data(), response.positions().data(), response.positions().size());
  double length = 0;
  for (int i = 1; i < 20; ++i) {
    length += std::hypot(p[3 * i] - p[3 * i - 3], p[3 * i + 1] - p[3 * i - 2],
                         p[3 * i + 2] - p[3 * i - 1]);
  }
  EXPECT_LE(length, 0.2 + 1e-12);
  EXPECT_GT(length, 0.198);             // The chords of a smooth curve are nearly as long as it.
  EXPECT_LT(p[3 * 19 + 1], 0.1 - 0.1);  // Clamped level at 0.1 m, the tip hangs.
  double residual;
  std::memcpy(&residual, response.residuals().data(), sizeof residual);
  EXPECT_LE(residual, 1e-9);
}

TEST_F(GroomServiceTest, BadRestShapeRequestsAreNamed) {
  const std::string name = server_.MakeGroom();
  const auto field = [&](const std::function<void(v1::ComputeRestShapeRequest*)>& spoil) {
    grpc::ClientContext context;
    v1::ComputeRestShapeRequest request;
    request.set_name(name);
    spoil(&request);
    v1::ComputeRestShapeResponse response;
    return NamedField(stub()->ComputeRestShape(&context, request, &response));
  };
  EXPECT_EQ(field([](auto* r) { r->set_points_per_guide(1); }), "points_per_guide");
  EXPECT_EQ(field([](auto* r) { r->mutable_gravity()->set_x(kNan); }), "gravity.x");
  EXPECT_EQ(field([](auto* r) { r->mutable_head_orientation()->set_x(2); }), "head_orientation");
  EXPECT_EQ(field([](auto* r) { r->set_name("grooms/none"); }), "name");
}

class BakeTest : public GroomServiceTest {
 protected:
  // `poses` poses at 60 Hz that sway sideways.
  static v1::BakeAnimationRequest Request(const std::string& groom, int poses) {
    std::vector<double> times, positions, orientations;
    for (int i = 0; i < poses; ++i) {
      times.push_back(i / 60.0);
      positions.insert(positions.end(), {0.01 * (i % 7), 0, 0});
      orientations.insert(orientations.end(), {0, 0, 0, 1});
    }
    const auto bytes = [](const std::vector<double>& v) {
      return std::string(reinterpret_cast<const char*>(v.data()), v.size() * sizeof(double));
    };
    v1::BakeAnimationRequest request;
    request.set_groom(groom);
    request.mutable_motion()->set_times_s(bytes(times));
    request.mutable_motion()->set_positions(bytes(positions));
    request.mutable_motion()->set_orientations(bytes(orientations));
    return request;
  }

  v1::Job Submit(const v1::BakeAnimationRequest& request, grpc::StatusCode expected) {
    grpc::ClientContext context;
    v1::Job job;
    const grpc::Status status =
        v1::BakeService::NewStub(server_.channel())->BakeAnimation(&context, request, &job);
    EXPECT_EQ(status.error_code(), expected) << status.error_message();
    field_ = NamedField(status);
    return job;
  }

  v1::Job Watch(const std::string& name) {
    grpc::ClientContext context;
    context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
    v1::WatchJobRequest request;
    request.set_name(name);
    const auto reader = v1::JobService::NewStub(server_.channel())->WatchJob(&context, request);
    v1::Job job;
    double progress = 0;
    while (reader->Read(&job)) {
      EXPECT_GE(job.progress(), progress);
      progress = job.progress();
    }
    EXPECT_TRUE(reader->Finish().ok());
    return job;
  }

  std::string field_;  // That the last Submit's error named.
};

TEST_F(BakeTest, ABakeHoldsTheFramesOfLockstep) {
  const std::string groom = server_.MakeGroom();
  const v1::BakeAnimationRequest request = Request(groom, 50);
  const v1::Job job = Watch(Submit(request, grpc::StatusCode::OK).name());
  ASSERT_EQ(job.state(), v1::Job::STATE_SUCCEEDED) << job.error();
  EXPECT_EQ(job.progress(), 1);
  server_.Restart();  // The result is kept.

  grpc::ClientContext context;
  v1::ReadBakeRequest read;
  read.set_name(job.name());
  const auto reader = v1::BakeService::NewStub(server_.channel())->ReadBake(&context, read);
  TestStream stream(server_, LockstepOf(groom));
  v1::HairFrame frame;
  for (int i = 0; i < 50; ++i) {
    ASSERT_TRUE(reader->Read(&frame));
    EXPECT_EQ(frame.index(), static_cast<uint64_t>(i + 1));
    ASSERT_TRUE(stream.Pose(i / 60.0, 0.01 * (i % 7)));
    EXPECT_EQ(frame.data(), stream.NextFrame()) << i;
  }
  EXPECT_FALSE(reader->Read(&frame));
  EXPECT_TRUE(reader->Finish().ok());
}

TEST_F(BakeTest, BadBakesAreNamedBeforeAnythingIsQueued) {
  const std::string groom = server_.MakeGroom();
  Submit(Request("grooms/none", 3), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(field_, "groom");
  Submit(Request(groom, 0), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(field_, "motion.times_s");
  v1::BakeAnimationRequest request = Request(groom, 3);
  request.mutable_motion()->mutable_positions()->pop_back();
  Submit(request, grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(field_, "motion.positions");
  request = Request(groom, 3);
  std::memcpy(request.mutable_motion()->mutable_positions()->data() + 8 * 4, &kNan, 8);
  Submit(request, grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(field_, "motion.positions[1].y");
  request = Request(groom, 3);
  std::memset(request.mutable_motion()->mutable_times_s()->data(), 0, 16);
  Submit(request, grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(field_, "motion.times_s[1]");
  std::vector<v1::Guide> guides(60);
  for (v1::Guide& guide : guides) {
    guide = GoodGuide(128);
    guide.set_wisp_radius_m(0.01);
  }
  v1::Groom large;  // 7680 elements whose wisps meet.
  ASSERT_TRUE(server_.Upload(UploadOf(guides), &large).ok());
  request = Request(large.name(), 3);
  request.set_substeps(64);
  Submit(request, grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(field_, "substeps");
}

TEST_F(BakeTest, ABakeOfAGroomMadeAnewIsAdmittedAnew) {
  const auto make = [&](int guides) {
    auto upload = UploadOf(std::vector<v1::Guide>(guides, GoodGuide(1)));
    upload[0].mutable_header()->set_groom_id("anew");
    v1::Groom groom;
    const grpc::Status status = server_.Upload(upload, &groom);
    EXPECT_TRUE(status.ok()) << status.error_message();
  };
  make(1);
  v1::BakeAnimationRequest first = Request(server_.MakeGroom(40), 9000);
  first.set_substeps(64);  // Minutes of work, which the other bake waits for.
  const v1::Job busy = Submit(first, grpc::StatusCode::OK);
  v1::BakeAnimationRequest request = Request("grooms/anew", 3);
  request.set_points_per_guide(256);
  const v1::Job job = Submit(request, grpc::StatusCode::OK);
  {
    grpc::ClientContext context;
    v1::DeleteGroomRequest remove;
    remove.set_name("grooms/anew");
    google::protobuf::Empty empty;
    const auto grooms = v1::GroomService::NewStub(server_.channel());
    ASSERT_TRUE(grooms->DeleteGroom(&context, remove, &empty).ok());
  }
  make(5500);  // 16.9 MB a frame.
  grpc::ClientContext context;
  v1::CancelJobRequest cancel;
  cancel.set_name(busy.name());
  v1::Job answer;
  ASSERT_TRUE(
      v1::JobService::NewStub(server_.channel())->CancelJob(&context, cancel, &answer).ok());
  const v1::Job ended = Watch(job.name());
  EXPECT_EQ(ended.state(), v1::Job::STATE_FAILED);
  // As the bake of the new groom is refused.
  Submit(request, grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(field_, "points_per_guide");
  EXPECT_TRUE(ended.error().starts_with("points_per_guide: a frame of")) << ended.error();
}

TEST_F(BakeTest, ABakeIsSubmittedOnceAndCanBeCancelled) {
  const std::string groom = server_.MakeGroom(40);
  v1::BakeAnimationRequest request = Request(groom, 9000);
  request.set_substeps(64);  // Minutes of work.
  request.set_request_id("bake-1");
  const v1::Job job = Submit(request, grpc::StatusCode::OK);
  EXPECT_EQ(Submit(request, grpc::StatusCode::OK).name(), job.name());

  const auto jobs = v1::JobService::NewStub(server_.channel());
  v1::Job answer;
  {
    grpc::ClientContext context;
    v1::DeleteJobRequest remove;
    remove.set_name(job.name());
    google::protobuf::Empty empty;
    EXPECT_EQ(jobs->DeleteJob(&context, remove, &empty).error_code(),
              grpc::StatusCode::FAILED_PRECONDITION);
  }
  grpc::ClientContext context;
  v1::CancelJobRequest cancel;
  cancel.set_name(job.name());
  ASSERT_TRUE(jobs->CancelJob(&context, cancel, &answer).ok());
  EXPECT_EQ(Watch(job.name()).state(), v1::Job::STATE_CANCELLED);
}

}  // namespace
}  // namespace mane::rpc
