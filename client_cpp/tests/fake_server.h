#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <functional>
#include <memory>
#include <string>

#include "mane/client.h"
#include "mane/v1/animation.grpc.pb.h"

namespace mane::client_test {

/// A server on loopback whose Animate calls follow a script; for answers that a sound daemon never
/// gives, or only at moments that a test cannot choose.
class FakeServer final : public v1::AnimationService::Service {
 public:
  using Stream = grpc::ServerReaderWriter<v1::AnimateResponse, v1::AnimateRequest>;
  /// Runs on a thread of its own for each call; `call` counts from 0.
  using Script =
      std::function<grpc::Status(int call, grpc::ServerContext& context, Stream& stream)>;

  explicit FakeServer(Script script);
  ~FakeServer() override;

  Client Connect() const;
  int calls() const { return calls_; }

  grpc::Status Animate(grpc::ServerContext* context, Stream* stream) override;

 private:
  Script script_;
  std::atomic<int> calls_ = 0;
  int port_ = 0;
  std::unique_ptr<grpc::Server> server_;
};

/// `opened` for one guide of one element and two points.
v1::AnimateResponse Opened(const std::string& token, std::uint64_t next_frame = 1);
/// A frame of that head.
v1::AnimateResponse HairFrame(std::uint64_t index, double time_s = 0);

/// Polls until `condition` holds; false after 20 s.
bool Eventually(const std::function<bool()>& condition);

}  // namespace mane::client_test
