#pragma once

#include <grpcpp/grpcpp.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "mane/v1/animation.grpc.pb.h"
#include "mane/v1/bake.grpc.pb.h"
#include "mane/v1/groom.grpc.pb.h"
#include "mane/v1/job.grpc.pb.h"
#include "rpc/server.h"

namespace mane::rpc {

/// A real server on a free port of loopback with a data folder of its own, and a channel to it.
class TestServer {
 public:
  explicit TestServer(ServerOptions options = {});
  ~TestServer();

  [[nodiscard]] const std::shared_ptr<grpc::Channel>& channel() const { return channel_; }
  [[nodiscard]] Server& server() { return *server_; }

  /// Stops the server and starts it again on the same data.
  void Restart();

  /// Uploads `messages` and commits; the answer goes to `groom`.
  grpc::Status Upload(const std::vector<v1::CreateGroomRequest>& messages, v1::Groom* groom);
  /// A groom of three guides of `elements` elements; its name.
  std::string MakeGroom(uint32_t elements = 4);

 private:
  void Start();

  ServerOptions options_;
  std::filesystem::path folder_;
  std::unique_ptr<Server> server_;
  std::shared_ptr<grpc::Channel> channel_;
};

/// One guide with everything in its range.
[[nodiscard]] v1::Guide GoodGuide(uint32_t elements = 4);

/// A header and one batch of `guides`.
[[nodiscard]] std::vector<v1::CreateGroomRequest> UploadOf(std::vector<v1::Guide> guides);

/// The field that a BadRequest detail names; empty without one.
[[nodiscard]] std::string NamedField(const grpc::Status& status);

/// A LOCKSTEP animation as a test plays it, message by message.
class TestStream {
 public:
  TestStream(TestServer& server, const v1::OpenHead& open);
  ~TestStream();

  bool Write(const v1::AnimateRequest& request) { return stream_->Write(request); }
  bool Pose(double time, double x);
  /// The next frame; a default one at the end. Other messages are passed over.
  v1::HairFrame NextWholeFrame();
  /// Its bytes.
  std::string NextFrame() { return NextWholeFrame().data(); }
  /// Half-closes, reads what is left, and returns how the call ended.
  grpc::Status Finish();
  void Cancel() { context_.TryCancel(); }

 private:
  grpc::ClientContext context_;
  std::unique_ptr<v1::AnimationService::Stub> stub_;
  std::unique_ptr<grpc::ClientReaderWriter<v1::AnimateRequest, v1::AnimateResponse>> stream_;
  bool finished_ = false;
};

[[nodiscard]] v1::OpenHead LockstepOf(const std::string& groom);

}  // namespace mane::rpc
