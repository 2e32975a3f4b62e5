#pragma once

#include <grpcpp/grpcpp.h>

#include <atomic>

#include "exec/worker_pool.h"
#include "rpc/groom_library.h"
#include "rpc/limits.h"

namespace mane::rpc {

/// What uploads may hold on to, as each keeps up to a whole groom in memory until it ends.
struct UploadLimits {
  int max_uploads = kMaxUploads;       ///< CreateGroom calls under way at once, at least 1.
  double max_idle_s = kMaxUploadIdle;  ///< Longest wait for an upload's next message [s], > 0.
};

/// The CreateGroom calls of a server; checks and solves on `solving`.
///
/// Threads: any. Outlives its calls.
class Uploads {
 public:
  Uploads(GroomLibrary& library, exec::WorkerPool& solving, const UploadLimits& limits)
      : library_(library), solving_(solving), limits_(limits) {}

  /// Begins one more, which ends with RESOURCE_EXHAUSTED where there are too many, and with
  /// DEADLINE_EXCEEDED where its client falls silent.
  grpc::ServerReadReactor<grpc::ByteBuffer>* Start(grpc::ByteBuffer* response);

 private:
  class Call;
  class Refusal;

  GroomLibrary& library_;
  exec::WorkerPool& solving_;
  const UploadLimits limits_;
  std::atomic<int> under_way_ = 0;
};

}  // namespace mane::rpc
