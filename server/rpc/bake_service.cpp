#include "rpc/bake_service.h"

#include <memory>
#include <utility>

#include "rpc/bake_job.h"
#include "rpc/chunk_stream.h"
#include "rpc/job_result.h"
#include "rpc/job_service.h"
#include "rpc/names.h"
#include "rpc/unary.h"
#include "stored.pb.h"

namespace mane::rpc {
namespace {

constexpr const char* kKind = "bake";
constexpr size_t kMaxRequestId = 64;

// The frames of a finished bake, one by one.
class BakeFrames {
 public:
  BakeFrames(storage::JobStore& store, std::string name) : chunks_(store, std::move(name), kKind) {}

  Result<std::optional<v1::HairFrame>> Next() {
    if (next_frame_ == chunk_.frames_size()) {
      const auto bytes = chunks_.Next();
      if (!bytes) return bytes.error();
      if (!bytes->has_value()) return std::optional<v1::HairFrame>();
      if (!chunk_.ParseFromString(**bytes) || chunk_.frames_size() == 0) {
        return JobResult::Damaged();
      }
      next_frame_ = 0;
    }
    return std::optional(std::move(*chunk_.mutable_frames(next_frame_++)));
  }

 private:
  JobResult chunks_;
  int next_frame_ = 0;
  BakeChunk chunk_;
};

}  // namespace

BakeService::BakeService(GroomLibrary& grooms, jobs::Queue& queue, storage::JobStore& store,
                         exec::WorkerPool& solving, exec::WorkerPool& requests)
    : grooms_(grooms), queue_(queue), store_(store), requests_(requests) {
  queue_.RegisterRunner(kKind,
                        [this, &solving](const storage::JobRecord&, jobs::JobContext& context) {
                          return RunBake(grooms_, solving, context);
                        });
}

grpc::ServerUnaryReactor* BakeService::BakeAnimation(grpc::CallbackServerContext* context,
                                                     const v1::BakeAnimationRequest* request,
                                                     v1::Job* response) {
  return Answer(context, requests_, [this, request, response]() -> Result<void> {
    auto bake = ToBake(*request);
    if (!bake) return bake.error();
    const auto groom = grooms_.Load(request->groom(), "groom");
    if (!groom) return groom.error();
    if (const auto ok = BindBodies(**groom, &*bake); !ok) return ok;
    if (const auto ok = AdmitBake(**groom, *bake); !ok) return ok;
    const auto text = CheckText(request->request_id(), kMaxRequestId, "request_id");
    if (!text) return text;
    const size_t poses = request->motion().times_s().size() / sizeof(double);
    const auto status = queue_.Submit({kKind, request->SerializeAsString(),
                                       fmt::format("{}, {} poses", request->groom(), poses),
                                       request->request_id()});
    if (!status) return status.error();
    FromStatus(*status, response);
    return {};
  });
}

grpc::ServerWriteReactor<v1::HairFrame>* BakeService::ReadBake(
    grpc::CallbackServerContext* /*context*/, const v1::ReadBakeRequest* request) {
  auto frames = std::make_shared<BakeFrames>(store_, request->name());
  return ChunkStream<v1::HairFrame>::Start(requests_, [frames] { return frames->Next(); });
}

}  // namespace mane::rpc
