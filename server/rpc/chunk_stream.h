#pragma once

#include <grpcpp/grpcpp.h>

#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <utility>

#include "exec/worker_pool.h"
#include "rpc/status.h"

namespace mane::rpc {

/// Streams what a producer yields, one message at a time: the next is made, on `requests`, when the
/// one before is written, so that a slow client holds no memory but one message.
///
/// Lifetime: owns itself until OnDone().
/// Threads:  either a write is under way or one task makes the next message, never both.
template <typename Message>
class ChunkStream final : public grpc::ServerWriteReactor<Message> {
 public:
  /// The next message; nothing at the end. Called on a worker, one call at a time.
  using Producer = std::function<Result<std::optional<Message>>()>;

  static ChunkStream* Start(exec::WorkerPool& requests, Producer producer) {
    auto* stream = new ChunkStream(requests, std::move(producer));
    stream->ProduceNext();
    return stream;
  }

  void OnWriteDone(bool ok) override {
    if (ok) {
      ProduceNext();
    } else {
      this->Finish(grpc::Status::CANCELLED);
    }
  }
  void OnDone() override { delete this; }

 private:
  ChunkStream(exec::WorkerPool& requests, Producer producer)
      : requests_(requests), producer_(std::move(producer)) {}

  void ProduceNext() {
    requests_.Post([this] {
      try {
        Result<std::optional<Message>> next = producer_();
        if (!next) return this->Finish(ToStatus(next.error()));
        if (!next->has_value()) return this->Finish(grpc::Status::OK);
        message_ = std::move(**next);
      } catch (const std::exception& fault) {
        return this->Finish(ToStatus(Error{ErrorCode::kInternal, fault.what(), ""}));
      }
      this->StartWrite(&message_);
    });
  }

  exec::WorkerPool& requests_;
  Producer producer_;
  Message message_;  // gRPC reads it until OnWriteDone().
};

}  // namespace mane::rpc
