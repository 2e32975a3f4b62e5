#include "rpc/job_service.h"

#include "rpc/convert_groom.h"
#include "rpc/job_watch.h"
#include "rpc/names.h"
#include "rpc/unary.h"

namespace mane::rpc {
namespace {

constexpr int kDefaultPageSize = 100;

// Applies `action` to the job called `name` and answers with its status.
template <typename Action>
Result<void> WithJob(const std::string& name, v1::Job* response, const Action& action) {
  const auto id = ParseName(name, "jobs", "name");
  if (!id) return id.error();
  const Result<jobs::JobStatus> status = action(*id);
  if (!status) return status.error();
  FromStatus(*status, response);
  return {};
}

}  // namespace

void FromStatus(const jobs::JobStatus& status, v1::Job* message) {
  const storage::JobRecord& job = status.job;
  message->set_name("jobs/" + job.id);
  message->set_kind(job.kind);
  message->set_state(static_cast<v1::Job::State>(job.state));
  message->set_progress(job.progress);
  message->set_seconds_left(status.seconds_left);
  message->set_error(job.error);
  message->set_description(job.description);
  message->set_result_bytes(static_cast<uint64_t>(job.result_bytes));
  FromNanoseconds(job.create_time_ns, message->mutable_create_time());
  if (job.start_time_ns != 0) FromNanoseconds(job.start_time_ns, message->mutable_start_time());
  if (job.end_time_ns != 0) FromNanoseconds(job.end_time_ns, message->mutable_end_time());
}

grpc::ServerUnaryReactor* JobService::GetJob(grpc::CallbackServerContext* context,
                                             const v1::GetJobRequest* request, v1::Job* response) {
  return Answer(context, requests_, [this, request, response] {
    return WithJob(request->name(), response, [this](const auto& id) { return queue_.Get(id); });
  });
}

grpc::ServerUnaryReactor* JobService::ListJobs(grpc::CallbackServerContext* context,
                                               const v1::ListJobsRequest* request,
                                               v1::ListJobsResponse* response) {
  return Answer(context, requests_, [this, request, response]() -> Result<void> {
    const int size = request->page_size() == 0 ? kDefaultPageSize : request->page_size();
    const auto page = queue_.List(size, request->page_token());
    if (!page) return page.error();
    for (const jobs::JobStatus& status : page->records) FromStatus(status, response->add_jobs());
    response->set_next_page_token(page->next_page_token);
    return {};
  });
}

grpc::ServerWriteReactor<v1::Job>* JobService::WatchJob(grpc::CallbackServerContext* /*context*/,
                                                        const v1::WatchJobRequest* request) {
  return JobWatch::Start(queue_, request->name());
}

grpc::ServerUnaryReactor* JobService::CancelJob(grpc::CallbackServerContext* context,
                                                const v1::CancelJobRequest* request,
                                                v1::Job* response) {
  return Answer(context, requests_, [this, request, response] {
    return WithJob(request->name(), response, [this](const auto& id) { return queue_.Cancel(id); });
  });
}

grpc::ServerUnaryReactor* JobService::DeleteJob(grpc::CallbackServerContext* context,
                                                const v1::DeleteJobRequest* request,
                                                google::protobuf::Empty* /*response*/) {
  return Answer(context, requests_, [this, request]() -> Result<void> {
    const auto id = ParseName(request->name(), "jobs", "name");
    if (!id) return id.error();
    return queue_.Delete(*id);
  });
}

}  // namespace mane::rpc
