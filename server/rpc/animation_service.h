#pragma once

#include <grpcpp/grpcpp.h>

#include "mane/v1/animation.grpc.pb.h"
#include "rpc/animate_stream.h"

namespace mane::rpc {

/// mane.v1.AnimationService: one AnimateStream a call. Raw, because a typed stream would take a
/// damaged message for the client's half-close.
class AnimationService final
    : public v1::AnimationService::WithRawCallbackMethod_Animate<v1::AnimationService::Service> {
 public:
  AnimationService(GroomLibrary& grooms, session::Registry& registry, exec::WorkerPool& requests,
                   double resume_grace)
      : grooms_(grooms), registry_(registry), requests_(requests), resume_grace_(resume_grace) {}

  grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>* Animate(
      grpc::CallbackServerContext* /*context*/) override {
    return AnimateStream::Start(grooms_, registry_, requests_, resume_grace_);
  }

 private:
  GroomLibrary& grooms_;
  session::Registry& registry_;
  exec::WorkerPool& requests_;
  const double resume_grace_;
};

}  // namespace mane::rpc
