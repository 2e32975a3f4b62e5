#pragma once

#include <grpcpp/grpcpp.h>

#include <deque>
#include <memory>
#include <mutex>
#include <optional>

#include "mane/v1/animation.pb.h"
#include "rpc/groom_library.h"
#include "session/registry.h"

namespace mane::rpc {

/// One Animate call: decodes what the client sends to its head, and sends what the head makes.
///
/// Lifetime: owns itself from Start() until OnDone(), which gRPC calls last; a task that opens the
///           head shares it meanwhile.
/// Threads:  the On*() reactions run on gRPC's few threads, the sink's calls on workers; `mutex_`
///           guards what stands below it. None of them blocks or computes: opening a head, which
///           may read the disk, runs on `requests`, or where distance fields must be made first on
///           the groom library's makers. Locks are taken in the order head's sink, stream, head's
///           own; the registry is never called under `mutex_`.
/// Errors:   a bad message ends the call with INVALID_ARGUMENT; other heads notice nothing.
class AnimateStream final : public grpc::ServerBidiReactor<grpc::ByteBuffer, grpc::ByteBuffer>,
                            public session::FrameSink {
 public:
  static AnimateStream* Start(GroomLibrary& grooms, session::Registry& registry,
                              exec::WorkerPool& requests, double resume_grace);

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

  void OnProgress() override;
  void OnNotice(const session::Notice& notice) override;
  void OnEnd(const Error& error) override;

 private:
  AnimateStream(GroomLibrary& grooms, session::Registry& registry, exec::WorkerPool& requests,
                double resume_grace)
      : grooms_(grooms), registry_(registry), requests_(requests), resume_grace_(resume_grace) {}

  // The reaction to one message; an error ends the call.
  Result<void> Handle(const v1::AnimateRequest& request);
  Result<void> ChangeModel(const v1::SetModel& message);
  void StartOpening(const v1::OpenHead& open);
  exec::WorkerPool* MakersOf(const std::string& groom);
  Result<session::OpenedHead> Open(const v1::OpenHead& open);
  [[nodiscard]] bool Ending();  // Nobody waits for the head any more.
  void FinishOpening(const Result<session::OpenedHead>& opened);
  [[nodiscard]] v1::AnimateResponse DescribeOpened(const session::OpenedHead& opened) const;

  // The rest needs `mutex_`.
  void ReadOnLocked();
  void WriteOnLocked();
  void CloseLocked(const grpc::Status& status);
  [[nodiscard]] bool DrainedLocked() const;

  GroomLibrary& grooms_;
  session::Registry& registry_;
  exec::WorkerPool& requests_;
  const double resume_grace_;
  std::shared_ptr<AnimateStream> self_;  // Until OnDone.

  std::mutex mutex_;
  std::shared_ptr<session::HeadSession> head_;  // Once opened; then it stays.
  grpc::ByteBuffer incoming_;
  grpc::ByteBuffer outgoing_;
  std::deque<v1::AnimateResponse> messages_;  // Opened and notices, before frames.
  bool open_asked_ = false;
  bool opening_ = false;
  bool reading_ = false;  // From StartRead() until the message is handled.
  bool writing_ = false;
  bool half_closed_ = false;            // The client has said all.
  bool broken_ = false;                 // The peer is gone: the head may be resumed.
  bool finished_ = false;               // Finish() was called.
  std::optional<grpc::Status> status_;  // To finish with, once nothing is being written or opened.
};

}  // namespace mane::rpc
