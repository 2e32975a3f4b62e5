// Animate against a real server over loopback: every kind of bad message ends its own stream with
// an error that names the field, and no other; vanishing clients leave nothing behind.

#include <grpcpp/generic/generic_stub.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <thread>

#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Plays ten poses and returns the frames.
std::vector<std::string> Play(TestStream& stream) {
  std::vector<std::string> frames;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(stream.Pose(i / 60.0, 0.01 * i * (i % 3)));
    frames.push_back(stream.NextFrame());
    EXPECT_FALSE(frames.back().empty());
  }
  return frames;
}

// Sends raw bytes as the messages of a streaming method; returns how the call ended.
grpc::Status SendRaw(TestServer& server, const std::string& method,
                     const std::vector<std::string>& messages) {
  grpc::GenericStub stub(server.channel());
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + std::chrono::seconds(60));
  grpc::CompletionQueue queue;
  const auto wait = [&queue] {
    void* tag;
    bool ok = false;
    EXPECT_TRUE(queue.Next(&tag, &ok));
    return ok;
  };
  const auto call = stub.PrepareCall(&context, method, &queue);
  call->StartCall(nullptr);
  wait();
  for (const std::string& message : messages) {
    const grpc::Slice slice(message);
    call->Write(grpc::ByteBuffer(&slice, 1), nullptr);
    if (!wait()) break;
  }
  grpc::ByteBuffer answer;
  for (bool more = true; more;) {
    call->Read(&answer, nullptr);
    more = wait();
  }
  grpc::Status status;
  call->Finish(&status, nullptr);
  wait();
  return status;
}

class AnimateTest : public ::testing::Test {
 protected:
  // Sends `request` on a stream of its own that has had one pose at time 1; how the stream ended.
  grpc::Status EndOf(const v1::AnimateRequest& request) {
    TestStream stream(server_, LockstepOf(groom_));
    EXPECT_TRUE(stream.Pose(1, 0));
    EXPECT_FALSE(stream.NextFrame().empty());
    stream.Write(request);
    return stream.Finish();
  }

  TestServer server_;
  std::string groom_ = server_.MakeGroom();
};

TEST_F(AnimateTest, EveryBadFieldIsNamedAndOthersGoOn) {
  struct Case {
    const char* field;
    std::function<void(v1::AnimateRequest*)> spoil;
  };
  const auto position = [](v1::AnimateRequest* r) {
    return r->mutable_pose()->mutable_pose()->mutable_position();
  };
  const auto orientation = [](v1::AnimateRequest* r) {
    return r->mutable_pose()->mutable_pose()->mutable_orientation();
  };
  const std::vector<Case> cases = {
      {"pose.time_s", [](auto* r) { r->mutable_pose()->set_time_s(kNan); }},
      {"pose.time_s", [](auto* r) { r->mutable_pose()->set_time_s(kInfinity); }},
      {"pose.time_s", [](auto* r) { r->mutable_pose()->set_time_s(1); }},
      {"pose.time_s", [](auto* r) { r->mutable_pose()->set_time_s(0.5); }},
      {"pose.time_s", [](auto* r) { r->mutable_pose()->set_time_s(2.5); }},
      {"pose.pose.position.x", [&](auto* r) { position(r)->set_x(kNan); }},
      {"pose.pose.position.y", [&](auto* r) { position(r)->set_y(-kInfinity); }},
      {"pose.pose.position.z", [&](auto* r) { position(r)->set_z(2e6); }},
      {"pose.pose.orientation", [&](auto* r) { orientation(r)->set_w(0); }},
      {"pose.pose.orientation", [&](auto* r) { orientation(r)->set_w(1.02); }},
      {"pose.pose.orientation", [&](auto* r) { orientation(r)->set_x(kNan); }},
      {"teleport.time_s", [](auto* r) { r->mutable_teleport()->set_time_s(kNan); }},
      {"environment.gravity.y",
       [](auto* r) { r->mutable_environment()->mutable_gravity()->set_y(kNan); }},
      {"environment.wind_velocity.x",
       [](auto* r) { r->mutable_environment()->mutable_wind_velocity()->set_x(101); }},
      {"environment.internal_friction_scale",
       [](auto* r) { r->mutable_environment()->set_internal_friction_scale(-1); }},
      {"environment.detail_tolerance_m",
       [](auto* r) { r->mutable_environment()->set_detail_tolerance_m(11); }},
      {"environment.air_drag_scale",
       [](auto* r) { r->mutable_environment()->set_air_drag_scale(kInfinity); }},
      {"model.model",
       [](auto* r) { r->mutable_model()->set_model(static_cast<v1::AnimationModel>(7)); }},
      {"model.beam.segments",
       [](auto* r) { r->mutable_model()->mutable_beam()->set_segments(65); }},
      {"model.beam.hold", [](auto* r) { r->mutable_model()->mutable_beam()->set_hold(kNan); }},
      {"model.beam.epsilon", [](auto* r) { r->mutable_model()->mutable_beam()->add_epsilon(0.5); }},
      {"model.beam.largest_turn_rad",  // Segments are as many as epsilon has numbers.
       [](auto* r) {
         for (int i = 0; i < 3; ++i) r->mutable_model()->mutable_beam()->add_epsilon(0.5);
         r->mutable_model()->mutable_beam()->add_largest_turn_rad(3);
       }},
      {"model.beam.largest_turn_rad[1]",
       [](auto* r) {
         r->mutable_model()->mutable_beam()->set_segments(2);
         r->mutable_model()->mutable_beam()->add_largest_turn_rad(3);
         r->mutable_model()->mutable_beam()->add_largest_turn_rad(3.2F);
       }},
      {"open", [this](auto* r) { *r->mutable_open() = LockstepOf(groom_); }},
      {"kind", [](auto*) {}},
  };
  TestStream witness(server_, LockstepOf(groom_));
  int step = 0;
  for (const Case& bad : cases) {
    v1::AnimateRequest request;
    bad.spoil(&request);
    const grpc::Status status = EndOf(request);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << bad.field;
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
    EXPECT_TRUE(witness.Pose(++step / 60.0, 0));
    EXPECT_FALSE(witness.NextFrame().empty());
  }
}

TEST_F(AnimateTest, AHeadIsAnimatedAsBeamsAndChangesItsModel) {
  v1::OpenHead open = LockstepOf(groom_);
  open.set_model(v1::ANIMATION_MODEL_BEAM);
  open.mutable_beam()->set_segments(6);
  TestStream stream(server_, open);
  const auto shown = [&](int i) {
    EXPECT_TRUE(stream.Pose(i / 60.0, 0.01 * i));
    return stream.NextWholeFrame();
  };
  const v1::HairFrame first = shown(1);
  EXPECT_EQ(first.model(), v1::ANIMATION_MODEL_BEAM);
  EXPECT_GT(first.stepped_elements(), 0U);
  EXPECT_EQ(first.stepped_elements() % 6, 0U);
  v1::AnimateRequest change;
  change.mutable_model()->set_model(v1::ANIMATION_MODEL_SUPER_HELIX);
  stream.Write(change);
  EXPECT_EQ(shown(2).model(), v1::ANIMATION_MODEL_SUPER_HELIX);
  change.mutable_model()->set_model(v1::ANIMATION_MODEL_BEAM);
  stream.Write(change);
  const v1::HairFrame last = shown(3);
  EXPECT_EQ(last.model(), v1::ANIMATION_MODEL_BEAM);  // And of as many segments as before.
  EXPECT_EQ(last.stepped_elements(), first.stepped_elements());
  EXPECT_EQ(last.data().size(), first.data().size());
  EXPECT_TRUE(stream.Finish().ok());
}

TEST_F(AnimateTest, GeneralizedFramesCannotShowBeams) {
  v1::OpenHead open = LockstepOf(groom_);
  open.set_format(v1::FRAME_FORMAT_GENERALIZED);
  TestStream stream(server_, open);
  v1::AnimateRequest change;
  change.mutable_model()->set_model(v1::ANIMATION_MODEL_BEAM);
  stream.Write(change);
  EXPECT_EQ(NamedField(stream.Finish()), "model.model");
}

TEST_F(AnimateTest, EveryBadOpenIsNamed) {
  struct Case {
    const char* field;
    grpc::StatusCode code;
    std::function<void(v1::OpenHead*)> spoil;
  };
  const auto kInvalid = grpc::StatusCode::INVALID_ARGUMENT;
  const std::vector<Case> cases = {
      {"open.groom", grpc::StatusCode::NOT_FOUND, [](auto* o) { o->set_groom("grooms/none"); }},
      {"open.groom", kInvalid, [](auto* o) { o->set_groom(""); }},
      {"open.groom", kInvalid, [](auto* o) { o->set_groom("grooms/../../etc"); }},
      {"open.pacing", kInvalid, [](auto* o) { o->set_pacing(v1::PACING_UNSPECIFIED); }},
      {"open.format", kInvalid, [](auto* o) { o->set_format(static_cast<v1::FrameFormat>(9)); }},
      {"open.model", kInvalid,
       [](auto* o) {
         o->set_format(v1::FRAME_FORMAT_GENERALIZED);
         o->set_model(v1::ANIMATION_MODEL_BEAM);
       }},
      {"open.beam.alpha", kInvalid, [](auto* o) { o->mutable_beam()->set_alpha(-1.5); }},
      {"open.beam.near_m", kInvalid, [](auto* o) { o->mutable_beam()->set_near_m(-1); }},
      {"open.beam.tip_response", kInvalid, [](auto* o) { o->mutable_beam()->set_tip_response(0); }},
      {"open.beam.fluctuation_rad", kInvalid,
       [](auto* o) { o->mutable_beam()->set_fluctuation_rad(kNan); }},
      {"open.beam.equations", kInvalid,
       [](auto* o) { o->mutable_beam()->set_equations(static_cast<v1::BeamEquations>(5)); }},
      {"open.space", kInvalid, [](auto* o) { o->set_space(static_cast<v1::Space>(-1)); }},
      {"open.points_per_guide", kInvalid, [](auto* o) { o->set_points_per_guide(1); }},
      {"open.points_per_guide", kInvalid, [](auto* o) { o->set_points_per_guide(257); }},
      {"open.rate_hz", kInvalid, [](auto* o) { o->set_rate_hz(kNan); }},
      {"open.rate_hz", kInvalid, [](auto* o) { o->set_rate_hz(241); }},
      {"open.substeps", kInvalid, [](auto* o) { o->set_substeps(65); }},
      {"open.pose_delay_s", kInvalid, [](auto* o) { o->set_pose_delay_s(-0.1); }},
      {"open.max_unacked_frames", kInvalid, [](auto* o) { o->set_max_unacked_frames(17); }},
      {"open.initial_pose.position.x", kInvalid,
       [](auto* o) { o->mutable_initial_pose()->mutable_position()->set_x(kNan); }},
      {"open.environment.gravity.z", kInvalid,
       [](auto* o) { o->mutable_environment()->mutable_gravity()->set_z(kInfinity); }},
      {"open.request_id", kInvalid, [](auto* o) { o->set_request_id(std::string(65, 'x')); }},
      {"open.resume", grpc::StatusCode::NOT_FOUND, [](auto* o) { o->set_resume("nothing"); }},
  };
  for (const Case& bad : cases) {
    v1::OpenHead open = LockstepOf(groom_);
    bad.spoil(&open);
    TestStream stream(server_, open);
    const grpc::Status status = stream.Finish();
    EXPECT_EQ(status.error_code(), bad.code) << bad.field << ": " << status.error_message();
    EXPECT_EQ(NamedField(status), bad.field) << status.error_message();
  }
}

TEST_F(AnimateTest, AQuaternionWithinOnePercentIsNormalised) {
  const auto frame = [this](double scale) {
    TestStream stream(server_, LockstepOf(groom_));
    v1::AnimateRequest request;
    v1::Quaternion* q = request.mutable_pose()->mutable_pose()->mutable_orientation();
    q->set_y(0.6 * scale);
    q->set_w(0.8 * scale);
    stream.Write(request);
    const std::string data = stream.NextFrame();
    EXPECT_TRUE(stream.Finish().ok());
    return data;
  };
  EXPECT_EQ(frame(1.0), frame(1.0));
  EXPECT_FALSE(frame(1.009).empty());
  EXPECT_FALSE(frame(0.991).empty());
}

TEST_F(AnimateTest, LockstepReplaysBitForBitWhateverRunsBeside) {
  TestStream first(server_, LockstepOf(groom_));
  const auto expected = Play(first);
  TestStream beside(server_, LockstepOf(server_.MakeGroom(7)));
  TestStream second(server_, LockstepOf(groom_));
  beside.Pose(0, 1);
  EXPECT_EQ(Play(second), expected);
  EXPECT_TRUE(second.Finish().ok());
  server_.Restart();
  TestStream third(server_, LockstepOf(groom_));
  EXPECT_EQ(Play(third), expected);
}

TEST_F(AnimateTest, AClientThatRunsAheadGetsEveryFrameInOrder) {
  constexpr int kPoses = 3000;
  TestStream stream(server_, LockstepOf(groom_));
  std::jthread writer([&stream] {
    for (int i = 0; i < kPoses; ++i) ASSERT_TRUE(stream.Pose(i / 60.0, 0.001 * (i % 50))) << i;
  });
  for (int i = 0; i < kPoses; ++i) {
    const auto frame = stream.NextWholeFrame();
    ASSERT_EQ(frame.index(), static_cast<uint64_t>(i + 1));
    ASSERT_EQ(frame.time_s(), i / 60.0);
  }
  writer.join();
  EXPECT_TRUE(stream.Finish().ok());
}

TEST_F(AnimateTest, DamagedMessagesAreToldFromTheEndOfAStream) {
  v1::AnimateRequest open;
  *open.mutable_open() = LockstepOf(groom_);
  for (const auto& messages : {std::vector<std::string>{"\xff\xff garbage"},
                               std::vector<std::string>{open.SerializeAsString(),
                                                        std::string("\x0a\xff\xff\xff\x7f", 5)}}) {
    const grpc::Status status = SendRaw(server_, "/mane.v1.AnimationService/Animate", messages);
    EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT) << status.error_message();
    EXPECT_NE(status.error_message().find("parse"), std::string::npos) << status.error_message();
  }
}

TEST_F(AnimateTest, TheFirstMessageMustOpen) {
  v1::AnimateRequest request;
  request.mutable_pose();
  const grpc::Status status =
      SendRaw(server_, "/mane.v1.AnimationService/Animate", {request.SerializeAsString()});
  EXPECT_EQ(status.error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(NamedField(status), "open");
}

TEST_F(AnimateTest, MessagesOverTheLimitAreRefused) {
  v1::AnimateRequest request;
  request.mutable_open()->set_groom(std::string(2 << 20, 'x'));
  const grpc::Status status =
      SendRaw(server_, "/mane.v1.AnimationService/Animate", {request.SerializeAsString()});
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
}

TEST(AnimateLimitTest, VanishingAndCancellingClientsLeaveNoHeadBehind) {
  TestServer server({.max_heads = 12});  // Of which some may still be closing.
  const std::string groom = server.MakeGroom();
  TestStream witness(server, LockstepOf(groom));
  ASSERT_TRUE(witness.Pose(0, 0));
  ASSERT_FALSE(witness.NextFrame().empty());
  for (int i = 0; i < 60; ++i) {
    v1::OpenHead open = LockstepOf(groom);
    if (i % 2 == 0) open.set_pacing(v1::PACING_REALTIME);
    TestStream stream(server, open);
    if (i % 3 != 0) {
      stream.Pose(0, 0);
      EXPECT_FALSE(stream.NextFrame().empty()) << i;
    }
    stream.Cancel();  // During the open, or in the middle.
    EXPECT_EQ(stream.Finish().error_code(), grpc::StatusCode::CANCELLED);
    ASSERT_TRUE(witness.Pose((i + 1) / 60.0, 0.01));
    ASSERT_FALSE(witness.NextFrame().empty());
  }
}

TEST(AnimateLimitTest, EightHeadsOfAHundredGuidesRunInRealTime) {
  TestServer server;
  v1::Groom groom;
  const grpc::Status uploaded =
      server.Upload(UploadOf(std::vector<v1::Guide>(100, GoodGuide(5))), &groom);
  ASSERT_TRUE(uploaded.ok()) << uploaded.error_message();
  v1::OpenHead open;
  open.set_groom(groom.name());
  open.set_pacing(v1::PACING_REALTIME);
  std::vector<std::unique_ptr<TestStream>> heads;
  for (int i = 0; i < 8; ++i) {
    heads.push_back(std::make_unique<TestStream>(server, open));
    EXPECT_FALSE(heads.back()->NextFrame().empty()) << i;
  }
}

TEST(AnimateLimitTest, HeadsBeyondTheLimitAreRefused) {
  TestServer server({.max_heads = 1});
  const std::string groom = server.MakeGroom();
  TestStream first(server, LockstepOf(groom));
  ASSERT_TRUE(first.Pose(0, 0));
  ASSERT_FALSE(first.NextFrame().empty());
  TestStream second(server, LockstepOf(groom));
  EXPECT_EQ(second.Finish().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  ASSERT_TRUE(first.Pose(0.1, 0));
  EXPECT_FALSE(first.NextFrame().empty());
}

TEST(AnimateLimitTest, DrainingTellsStreamsAndEndsThem) {
  TestServer server;
  TestStream stream(server, LockstepOf(server.MakeGroom()));
  ASSERT_TRUE(stream.Pose(0, 0));
  ASSERT_FALSE(stream.NextFrame().empty());
  server.server().Drain(0.1);
  EXPECT_EQ(stream.Finish().error_code(), grpc::StatusCode::UNAVAILABLE);
}

}  // namespace
}  // namespace mane::rpc
