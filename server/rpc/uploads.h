#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>
#include <memory>

#include "exec/worker_pool.h"
#include "rpc/limits.h"
#include "rpc/raw.h"

namespace mane::rpc {

/// What one uploading call gathers from its messages.
class Upload {
 public:
  virtual ~Upload() = default;
  /// Takes the next message; true when it was the last one, which says that all have come.
  virtual Result<bool> Add(grpc::ByteBuffer* message) = 0;
  /// All are in: the answer. Ends with kCancelled soon after `cancelled` is set.
  virtual Result<grpc::ByteBuffer> Finish(const std::atomic<bool>& cancelled) = 0;
};

/// An upload by a class that has Add(const Request&) -> Result<bool> and
/// Finish(cancelled) -> Result<Response>, messages both.
template <typename Request, typename Messages>
class UploadOf final : public Upload {
 public:
  template <typename... Arguments>
  explicit UploadOf(Arguments&&... arguments) : messages_(std::forward<Arguments>(arguments)...) {}

  Result<bool> Add(grpc::ByteBuffer* message) override {
    Request request;
    if (const auto parsed = Parse(message, &request); !parsed) return parsed.error();
    return messages_.Add(request);
  }
  Result<grpc::ByteBuffer> Finish(const std::atomic<bool>& cancelled) override {
    const auto response = messages_.Finish(cancelled);
    if (!response) return response.error();
    return Serialize(*response);
  }

 private:
  Messages messages_;
};

/// What uploads may hold on to, as each keeps up to a whole groom in memory until it ends.
struct UploadLimits {
  int max_uploads = kMaxUploads;       ///< Calls under way at once, at least 1.
  double max_idle_s = kMaxUploadIdle;  ///< Longest wait for an upload's next message [s], > 0.
};

/// The uploading calls of a server; checks and solves on `solving`.
///
/// Threads: any. Outlives its calls.
class Uploads {
 public:
  Uploads(exec::WorkerPool& solving, const UploadLimits& limits)
      : solving_(solving), limits_(limits) {}

  /// Begins one more, which ends with RESOURCE_EXHAUSTED where there are too many, and with
  /// DEADLINE_EXCEEDED where its client falls silent.
  grpc::ServerReadReactor<grpc::ByteBuffer>* Start(std::unique_ptr<Upload> upload,
                                                   grpc::ByteBuffer* response);

 private:
  class Call;
  class Refusal;

  exec::WorkerPool& solving_;
  const UploadLimits limits_;
  std::atomic<int> under_way_ = 0;
};

}  // namespace mane::rpc
