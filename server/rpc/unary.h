#pragma once

#include <grpcpp/grpcpp.h>

#include <exception>
#include <utility>

#include "exec/worker_pool.h"
#include "rpc/status.h"

namespace mane::rpc {

/// Answers a unary call with what `work` returns, run on `requests`: gRPC's few threads must not
/// wait for a disk or a solver. gRPC keeps context, request and response until the call is
/// finished.
template <typename Work>
grpc::ServerUnaryReactor* Answer(grpc::CallbackServerContext* context, exec::WorkerPool& requests,
                                 Work work) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  requests.Post([reactor, work = std::move(work)] {
    grpc::Status status;
    try {
      status = ToStatus(work());
    } catch (const std::exception& fault) {
      status = ToStatus(Error{ErrorCode::kInternal, fault.what(), ""});
    }
    reactor->Finish(status);
  });
  return reactor;
}

}  // namespace mane::rpc
