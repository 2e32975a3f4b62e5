#pragma once

#include <grpcpp/grpcpp.h>

#include "exec/worker_pool.h"
#include "jobs/queue.h"
#include "mane/v1/style.grpc.pb.h"
#include "rpc/groom_library.h"
#include "rpc/style_job.h"
#include "rpc/uploads.h"
#include "storage/job_store.h"

namespace mane::rpc {

// ApplyStyle is raw: a typed stream would take a damaged message for the end of the upload.
using StylingServiceBase = v1::StylingService::WithRawCallbackMethod_ApplyStyle<
    v1::StylingService::WithCallbackMethod_ReadHairstyle<
        v1::StylingService::WithCallbackMethod_ListStylePresets<v1::StylingService::Service>>>;

/// mane.v1.StylingService: submits styles, which run as jobs of kind `style`, and reads what they
/// made.
class StylingService final : public StylingServiceBase {
 public:
  /// Registers the runner; styles are applied on `solving`, other work runs on `requests`.
  StylingService(GroomLibrary& grooms, jobs::Queue& queue, storage::JobStore& store,
                 exec::WorkerPool& solving, exec::WorkerPool& requests, Uploads& uploads);

  grpc::ServerReadReactor<grpc::ByteBuffer>* ApplyStyle(grpc::CallbackServerContext* context,
                                                        grpc::ByteBuffer* response) override;
  grpc::ServerWriteReactor<v1::HairstylePart>* ReadHairstyle(
      grpc::CallbackServerContext* context, const v1::ReadHairstyleRequest* request) override;
  grpc::ServerUnaryReactor* ListStylePresets(grpc::CallbackServerContext* context,
                                             const v1::ListStylePresetsRequest* request,
                                             v1::ListStylePresetsResponse* response) override;

 private:
  GroomLibrary& grooms_;
  jobs::Queue& queue_;
  storage::JobStore& store_;
  exec::WorkerPool& requests_;
  Uploads& uploads_;
  StyleJobs jobs_;
};

}  // namespace mane::rpc
