#pragma once

#include <grpcpp/grpcpp.h>

#include "exec/worker_pool.h"
#include "jobs/queue.h"
#include "mane/v1/job.grpc.pb.h"

namespace mane::rpc {

/// A job as the API shows it.
void FromStatus(const jobs::JobStatus& status, v1::Job* message);

/// mane.v1.JobService over the queue. Work runs on `requests`.
class JobService final : public v1::JobService::CallbackService {
 public:
  JobService(jobs::Queue& queue, exec::WorkerPool& requests) : queue_(queue), requests_(requests) {}

  grpc::ServerUnaryReactor* GetJob(grpc::CallbackServerContext* context,
                                   const v1::GetJobRequest* request, v1::Job* response) override;
  grpc::ServerUnaryReactor* ListJobs(grpc::CallbackServerContext* context,
                                     const v1::ListJobsRequest* request,
                                     v1::ListJobsResponse* response) override;
  grpc::ServerWriteReactor<v1::Job>* WatchJob(grpc::CallbackServerContext* context,
                                              const v1::WatchJobRequest* request) override;
  grpc::ServerUnaryReactor* CancelJob(grpc::CallbackServerContext* context,
                                      const v1::CancelJobRequest* request,
                                      v1::Job* response) override;
  grpc::ServerUnaryReactor* DeleteJob(grpc::CallbackServerContext* context,
                                      const v1::DeleteJobRequest* request,
                                      google::protobuf::Empty* response) override;

 private:
  jobs::Queue& queue_;
  exec::WorkerPool& requests_;
};

}  // namespace mane::rpc
