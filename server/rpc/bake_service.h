#pragma once

#include <grpcpp/grpcpp.h>

#include "exec/worker_pool.h"
#include "jobs/queue.h"
#include "mane/v1/bake.grpc.pb.h"
#include "rpc/groom_library.h"
#include "storage/job_store.h"

namespace mane::rpc {

/// mane.v1.BakeService: submits bakes, which run as jobs of kind `bake`, and reads their frames.
class BakeService final : public v1::BakeService::CallbackService {
 public:
  /// Registers the runner; bakes advance on `solving`, other work runs on `requests`.
  BakeService(GroomLibrary& grooms, jobs::Queue& queue, storage::JobStore& store,
              exec::WorkerPool& solving, exec::WorkerPool& requests);

  grpc::ServerUnaryReactor* BakeAnimation(grpc::CallbackServerContext* context,
                                          const v1::BakeAnimationRequest* request,
                                          v1::Job* response) override;
  grpc::ServerWriteReactor<v1::HairFrame>* ReadBake(grpc::CallbackServerContext* context,
                                                    const v1::ReadBakeRequest* request) override;

 private:
  GroomLibrary& grooms_;
  jobs::Queue& queue_;
  storage::JobStore& store_;
  exec::WorkerPool& requests_;
};

}  // namespace mane::rpc
