#include "rpc/styling_service.h"

#include <memory>
#include <utility>

#include "rpc/chunk_stream.h"
#include "rpc/job_result.h"
#include "rpc/style_presets.h"
#include "rpc/style_upload.h"
#include "rpc/unary.h"

namespace mane::rpc {
StylingService::StylingService(GroomLibrary& grooms, jobs::Queue& queue, storage::JobStore& store,
                               exec::WorkerPool& solving, exec::WorkerPool& requests,
                               Uploads& uploads)
    : grooms_(grooms),
      queue_(queue),
      store_(store),
      requests_(requests),
      uploads_(uploads),
      jobs_(grooms, solving) {
  queue_.RegisterRunner(kStyleKind,
                        [this](const storage::JobRecord& job, jobs::JobContext& context) {
                          return jobs_.Run(job.id, context);
                        });
}

grpc::ServerReadReactor<grpc::ByteBuffer>* StylingService::ApplyStyle(
    grpc::CallbackServerContext* /*context*/, grpc::ByteBuffer* response) {
  return uploads_.Start(
      std::make_unique<UploadOf<v1::ApplyStyleRequest, StyleUpload>>(grooms_, queue_), response);
}

grpc::ServerWriteReactor<v1::HairstylePart>* StylingService::ReadHairstyle(
    grpc::CallbackServerContext* /*context*/, const v1::ReadHairstyleRequest* request) {
  auto chunks = std::make_shared<JobResult>(store_, request->name(), kStyleKind);
  return ChunkStream<v1::HairstylePart>::Start(
      requests_, [chunks]() -> Result<std::optional<v1::HairstylePart>> {
        const auto bytes = chunks->Next();
        if (!bytes) return bytes.error();
        if (!bytes->has_value()) return std::optional<v1::HairstylePart>();
        v1::HairstylePart part;
        if (!part.ParseFromString(**bytes)) return JobResult::Damaged();
        return std::optional(std::move(part));
      });
}

grpc::ServerUnaryReactor* StylingService::ListStylePresets(
    grpc::CallbackServerContext* context, const v1::ListStylePresetsRequest* /*request*/,
    v1::ListStylePresetsResponse* response) {
  return Answer(context, requests_, [response]() -> Result<void> {
    *response = StylePresets();
    return {};
  });
}

}  // namespace mane::rpc
