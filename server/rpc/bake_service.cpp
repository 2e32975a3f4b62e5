#include "rpc/bake_service.h"

#include <memory>
#include <utility>

#include "rpc/bake_job.h"
#include "rpc/chunk_stream.h"
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
  BakeFrames(storage::JobStore& store, std::string name) : store_(store), name_(std::move(name)) {}

  Result<std::optional<v1::HairFrame>> Next() {
    if (chunk_count_ < 0) {
      if (const auto ok = Find(); !ok) return ok.error();
    }
    if (next_frame_ == chunk_.frames_size()) {
      if (next_chunk_ == chunk_count_) return std::optional<v1::HairFrame>();
      const auto bytes = store_.ReadResult(id_, next_chunk_++);
      if (!bytes) return bytes.error();
      if (!chunk_.ParseFromString(*bytes) || chunk_.frames_size() == 0) {
        return Error{ErrorCode::kInternal, "the stored result is damaged", ""};
      }
      next_frame_ = 0;
    }
    return std::optional(std::move(*chunk_.mutable_frames(next_frame_++)));
  }

 private:
  Result<void> Find() {
    const auto id = ParseName(name_, "jobs", "name");
    if (!id) return id.error();
    id_ = *id;
    const auto job = store_.Get(id_);
    if (!job) return job.error();
    if (job->kind != kKind || job->state != storage::JobState::kSucceeded) {
      return Error{ErrorCode::kFailedPrecondition,
                   fmt::format("{} is no bake that succeeded; watch it until its state is "
                               "SUCCEEDED",
                               name_),
                   "name"};
    }
    chunk_count_ = job->result_chunks;
    return {};
  }

  storage::JobStore& store_;
  const std::string name_;
  std::string id_;
  int64_t chunk_count_ = -1;  // Until the job is found.
  int64_t next_chunk_ = 0;
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
