#include "rpc/test_server.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <utility>

#include "status.pb.h"

namespace mane::rpc {
namespace {

std::filesystem::path MakeFolder() {
  std::string path = (std::filesystem::temp_directory_path() / "mane-rpc-XXXXXX").string();
  EXPECT_NE(mkdtemp(path.data()), nullptr);
  return path;
}

auto Deadline() { return std::chrono::system_clock::now() + std::chrono::seconds(60); }

}  // namespace

TestServer::TestServer(ServerOptions options)
    : options_(std::move(options)), folder_(MakeFolder()) {
  options_.listen = "127.0.0.1:0";
  options_.data_dir = folder_.string();
  Start();
}

TestServer::~TestServer() {
  channel_.reset();
  server_.reset();
  std::filesystem::remove_all(folder_);
}

void TestServer::Start() {
  auto server = Server::Start(options_);
  if (!server) {
    ADD_FAILURE() << server.error().message;
    std::abort();
  }
  server_ = *std::move(server);
  // A channel of its own: gRPC would share connections, and their back-off, between equal ones.
  grpc::ChannelArguments arguments;
  arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);
  channel_ = grpc::CreateCustomChannel("127.0.0.1:" + std::to_string(server_->port()),
                                       grpc::InsecureChannelCredentials(), arguments);
}

void TestServer::Restart() {
  server_.reset();
  Start();
}

grpc::Status TestServer::Upload(const std::vector<v1::CreateGroomRequest>& messages,
                                v1::Groom* groom) {
  grpc::ClientContext context;
  context.set_deadline(Deadline());
  const auto stub = v1::GroomService::NewStub(channel_);
  const auto writer = stub->CreateGroom(&context, groom);
  for (const v1::CreateGroomRequest& message : messages) {
    if (!writer->Write(message)) break;
  }
  v1::CreateGroomRequest commit;
  commit.mutable_commit();
  writer->Write(commit);
  writer->WritesDone();
  return writer->Finish();
}

std::string TestServer::MakeGroom(uint32_t elements) {
  v1::Groom groom;
  const grpc::Status status =
      Upload(UploadOf({GoodGuide(elements), GoodGuide(elements), GoodGuide(elements)}), &groom);
  EXPECT_TRUE(status.ok()) << status.error_message();
  return groom.name();
}

v1::Guide GoodGuide(uint32_t elements) {
  v1::Guide guide;
  guide.mutable_root_position()->set_y(0.1);
  guide.set_length_m(0.2);
  guide.set_element_count(elements);
  guide.set_radius_1_m(4e-5);
  guide.set_radius_2_m(3.5e-5);
  guide.set_young_modulus_pa(2e9);
  guide.set_poisson_ratio(0.48);
  guide.set_density_kg_m3(1300);
  guide.set_internal_friction(1e-10);
  guide.set_air_drag(5e-6);
  guide.add_natural_curvature_1(20);
  return guide;
}

std::vector<v1::CreateGroomRequest> UploadOf(std::vector<v1::Guide> guides) {
  std::vector<v1::CreateGroomRequest> messages(2);
  messages[0].mutable_header()->set_display_name("test");
  v1::GuideBatch* batch = messages[1].mutable_guides();
  for (v1::Guide& guide : guides) *batch->add_guides() = std::move(guide);
  return messages;
}

std::string NamedField(const grpc::Status& status) {
  Status details;
  if (!details.ParseFromString(status.error_details()) || details.details_size() == 0) return "";
  BadRequest bad_request;
  if (details.details(0).type_url() != "type.googleapis.com/google.rpc.BadRequest" ||
      !bad_request.ParseFromString(details.details(0).value())) {
    return "";
  }
  return bad_request.field_violations(0).field();
}

v1::OpenHead LockstepOf(const std::string& groom) {
  v1::OpenHead open;
  open.set_groom(groom);
  open.set_pacing(v1::PACING_LOCKSTEP);
  return open;
}

TestStream::TestStream(TestServer& server, const v1::OpenHead& open)
    : stub_(v1::AnimationService::NewStub(server.channel())) {
  context_.set_deadline(Deadline());
  stream_ = stub_->Animate(&context_);
  v1::AnimateRequest request;
  *request.mutable_open() = open;
  Write(request);
}

TestStream::~TestStream() {
  if (finished_) return;
  Cancel();
  (void)Finish();
}

bool TestStream::Pose(double time, double x) {
  v1::AnimateRequest request;
  request.mutable_pose()->set_time_s(time);
  request.mutable_pose()->mutable_pose()->mutable_position()->set_x(x);
  return Write(request);
}

v1::HairFrame TestStream::NextWholeFrame() {
  v1::AnimateResponse response;
  while (stream_->Read(&response)) {
    if (response.has_frame()) return response.frame();
  }
  return {};
}

grpc::Status TestStream::Finish() {
  finished_ = true;
  stream_->WritesDone();
  v1::AnimateResponse response;
  while (stream_->Read(&response)) {
  }
  return stream_->Finish();
}

}  // namespace mane::rpc
