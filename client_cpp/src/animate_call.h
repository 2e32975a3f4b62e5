#pragma once

#include <grpcpp/grpcpp.h>

#include <memory>

#include "mane/v1/animation.grpc.pb.h"
#include "transport.h"

namespace mane::inline client {

/// One try at the Animate stream.
///
/// Lifetime: created by Start(), owned by gRPC until OnDone, which hands it to Events::OnCallDone.
///           A hold keeps it alive for writes that start outside reactions, until the reads end.
/// Threads:  the caller serialises Write() and HalfClose(), starts none after
///           Events::OnReadsEnded() or while one is under way. Cancel() may come at any time before
///           OnCallDone. Events come from gRPC's threads, at most one read and one write at once.
class AnimateCall final : public grpc::ClientBidiReactor<v1::AnimateRequest, v1::AnimateResponse> {
 public:
  class Events {
   public:
    virtual ~Events() = default;
    virtual void OnResponse(const v1::AnimateResponse& response) = 0;
    virtual void OnWritten() = 0;     ///< The write is out; the next may start.
    virtual void OnReadsEnded() = 0;  ///< No write may start after this.
    /// Last of all events. The receiver drops `call`.
    virtual void OnCallDone(std::unique_ptr<AnimateCall> call, const grpc::Status& status) = 0;
  };

  /// Starts the call with its first message.
  static AnimateCall* Start(const Transport& transport, std::shared_ptr<Events> events,
                            v1::AnimateRequest first);

  void Write(v1::AnimateRequest request);
  void HalfClose() { StartWritesDone(); }
  void Cancel() { context_.TryCancel(); }

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnDone(const grpc::Status& status) override;

 private:
  explicit AnimateCall(std::shared_ptr<Events> events) : events_(std::move(events)) {}

  std::shared_ptr<Events> events_;
  grpc::ClientContext context_;
  v1::AnimateRequest request_;    // gRPC reads it until OnWriteDone().
  v1::AnimateResponse response_;  // gRPC writes it until OnReadDone().
};

}  // namespace mane::inline client
