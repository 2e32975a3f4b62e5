#pragma once

#include <grpcpp/grpcpp.h>

#include <chrono>
#include <memory>
#include <string>

#include "mane/client.h"
#include "mane/v1/animation.grpc.pb.h"
#include "mane/v1/groom.grpc.pb.h"

namespace mane::inline client {

/// One channel with its stubs and credentials. Immutable and thread-safe; shared by the Client and
/// its heads.
class Transport {
 public:
  /// Connects, waiting at most `options.connect_timeout`.
  static Result<std::shared_ptr<Transport>> Connect(const ClientOptions& options);

  /// Puts the token into `context`.
  void Authorize(grpc::ClientContext& context) const;
  /// Authorize() and a deadline of `call_timeout` from now.
  void PrepareCall(grpc::ClientContext& context) const;

  v1::GroomService::Stub& grooms() const { return *grooms_; }
  v1::AnimationService::Stub& animation() const { return *animation_; }

 private:
  Transport(const std::shared_ptr<grpc::Channel>& channel, std::string token,
            std::chrono::milliseconds call_timeout);

  std::unique_ptr<v1::GroomService::Stub> grooms_;
  std::unique_ptr<v1::AnimationService::Stub> animation_;
  std::string token_;
  std::chrono::milliseconds call_timeout_;
};

}  // namespace mane::inline client
