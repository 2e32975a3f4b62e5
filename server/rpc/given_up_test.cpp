// What nobody waits for any more is not worked on: distance fields of uploads, hair that settles
// for heads and bakes. And nothing of that is begun for who is not let in.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "rpc/test_server.h"

namespace mane::rpc {
namespace {

using std::chrono::duration;
using std::chrono::steady_clock;

double SecondsSince(steady_clock::time_point begin) {
  return duration<double>(steady_clock::now() - begin).count();
}

// A thousand tetrahedra on one heap: a distance field of it would take minutes.
v1::Body Heap(int seed) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> place(-0.05F, 0.05F);
  std::vector<float> vertices;
  std::vector<uint32_t> triangles;
  for (uint32_t i = 0; i < 1000; ++i) {
    const float centre[3] = {place(rng), place(rng), place(rng)};
    for (const auto& [x, y, z] : {std::array{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}) {
      vertices.insert(vertices.end(), {centre[0] + 0.06F * static_cast<float>(x),
                                       centre[1] + 0.06F * static_cast<float>(y),
                                       centre[2] + 0.06F * static_cast<float>(z)});
    }
    const uint32_t v = 4 * i;
    triangles.insert(triangles.end(),
                     {v, v + 2, v + 1, v, v + 1, v + 3, v, v + 3, v + 2, v + 1, v + 2, v + 3});
  }
  v1::Body body;
  body.set_name("heap");
  body.mutable_mesh()->set_vertices(vertices.data(), vertices.size() * sizeof(float));
  body.mutable_mesh()->set_triangles(triangles.data(), triangles.size() * sizeof(uint32_t));
  return body;
}

v1::Body Ball(const std::string& name) {
  v1::Body body;
  body.set_name(name);
  body.mutable_capsule()->set_radius_m(0.05);
  return body;
}

class GivenUpTest : public ::testing::Test {
 protected:
  // 32,768 elements among 60 bodies: hair settles in seconds at least, ten of one core; a frame
  // takes some hundredths.
  std::string MakeLarge() {
    auto messages = UploadOf(std::vector<v1::Guide>(256, GoodGuide(128)));
    for (int i = 0; i < 60; ++i) {
      v1::Body ball = Ball(fmt::format("b{}", i));
      ball.set_moving(true);
      ball.mutable_pose()->mutable_position()->set_x(0.02 * (i % 10) - 0.1);
      ball.mutable_pose()->mutable_position()->set_z(0.04 * (i / 10) - 0.1);
      *messages.emplace_back().mutable_body() = ball;
    }
    v1::Groom groom;
    const grpc::Status status = server_.Upload(messages, &groom);
    EXPECT_TRUE(status.ok()) << status.error_message();
    return groom.name();
  }

  TestServer server_;
};

TEST_F(GivenUpTest, UploadsFreeTheWorkersThatTheyHad) {
  std::vector<std::jthread> clients;
  for (int i = 0; i < 4; ++i) {  // More than there are workers for uploads.
    clients.emplace_back([this, i] {
      grpc::ClientContext context;
      context.set_deadline(std::chrono::system_clock::now() + std::chrono::milliseconds(500));
      v1::Groom groom;
      const auto writer =
          v1::GroomService::NewStub(server_.channel())->CreateGroom(&context, &groom);
      for (const v1::CreateGroomRequest& message : UploadOf({GoodGuide()})) writer->Write(message);
      v1::CreateGroomRequest last;
      *last.mutable_body() = Heap(i);
      writer->Write(last);
      last.mutable_commit();
      writer->Write(last);
      writer->WritesDone();
      EXPECT_EQ(writer->Finish().error_code(), grpc::StatusCode::DEADLINE_EXCEEDED);
    });
  }
  clients.clear();
  const auto begin = steady_clock::now();
  server_.MakeGroom();
  EXPECT_LT(SecondsSince(begin), 5);
}

TEST_F(GivenUpTest, ABakeStopsWhileHairSettles) {
  v1::BakeAnimationRequest request;
  request.set_groom(MakeLarge());
  const double times[2] = {0, 1 / 60.0}, positions[6] = {},
               orientations[8] = {0, 0, 0, 1, 0, 0, 0, 1};
  request.mutable_motion()->set_times_s(times, sizeof times);
  request.mutable_motion()->set_positions(positions, sizeof positions);
  request.mutable_motion()->set_orientations(orientations, sizeof orientations);
  v1::Job job;
  {
    grpc::ClientContext context;
    const grpc::Status status =
        v1::BakeService::NewStub(server_.channel())->BakeAnimation(&context, request, &job);
    ASSERT_TRUE(status.ok()) << status.error_message();  // One budget for bakes and heads.
  }
  const auto jobs = v1::JobService::NewStub(server_.channel());
  while (job.state() == v1::Job::STATE_QUEUED) {
    grpc::ClientContext context;
    v1::GetJobRequest get;
    get.set_name(job.name());
    ASSERT_TRUE(jobs->GetJob(&context, get, &job).ok());
  }
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const auto begin = steady_clock::now();
  {
    grpc::ClientContext context;
    v1::CancelJobRequest cancel;
    cancel.set_name(job.name());
    ASSERT_TRUE(jobs->CancelJob(&context, cancel, &job).ok());
  }
  grpc::ClientContext context;
  v1::WatchJobRequest watch;
  watch.set_name(job.name());
  const auto reader = jobs->WatchJob(&context, watch);
  while (reader->Read(&job)) {
  }
  EXPECT_EQ(job.state(), v1::Job::STATE_CANCELLED);
  EXPECT_LT(SecondsSince(begin), 2);
}

TEST_F(GivenUpTest, AHeadThatIsNotLetInIsToldBeforeHairSettles) {
  v1::OpenHead open = LockstepOf(MakeLarge());
  open.set_substeps(64);
  const auto begin = steady_clock::now();
  TestStream stream(server_, open);
  const grpc::Status status = stream.Finish();
  EXPECT_EQ(status.error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED) << status.error_message();
  EXPECT_EQ(NamedField(status), "open.substeps");
  EXPECT_LT(SecondsSince(begin), 2);
}

TEST_F(GivenUpTest, OpeningSmallHeadsGoesOnWhileALargeOneSettles) {
  v1::Groom small;
  auto messages = UploadOf({GoodGuide()});
  *messages.emplace_back().mutable_body() = Ball("ball");
  ASSERT_TRUE(server_.Upload(messages, &small).ok());
  TestStream large(server_, LockstepOf(MakeLarge()));
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  const auto begin = steady_clock::now();
  TestStream stream(server_, LockstepOf(small.name()));
  stream.Pose(0, 0);
  EXPECT_FALSE(stream.NextFrame().empty());
  EXPECT_LT(SecondsSince(begin), 5);
  large.Cancel();
  // It leaves, and the server, which waits for all streams, stops soon.
  (void)large.Finish();
  const auto leaving = steady_clock::now();
  server_.Restart();
  EXPECT_LT(SecondsSince(leaving), 5);
}

}  // namespace
}  // namespace mane::rpc
