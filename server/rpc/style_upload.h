#pragma once

#include <atomic>

#include "base/result.h"
#include "groom/groom.h"
#include "jobs/queue.h"
#include "mane/v1/style.pb.h"
#include "rpc/body_upload.h"
#include "rpc/groom_library.h"

namespace mane::rpc {

/// The messages of one ApplyStyle call, gathered and checked as they come; then a job of kind
/// kStyleKind.
class StyleUpload {
 public:
  StyleUpload(GroomLibrary& library, jobs::Queue& queue)
      : library_(library), queue_(queue), bodies_(library.limits()) {}

  /// Takes the next message; true when it was `commit`, the last. kInvalidArgument or
  /// kResourceExhausted names the field.
  Result<bool> Add(const v1::ApplyStyleRequest& request);
  /// All messages are in: submits the job.
  Result<v1::Job> Finish(const std::atomic<bool>& cancelled);

 private:
  Result<void> AddHeader(const v1::ApplyStyleHeader& header);
  Result<void> AddMesh(const v1::TriangleMesh& piece);
  // Whether the groom is there, and not because this request was made before.
  bool IsTaken();

  GroomLibrary& library_;
  jobs::Queue& queue_;
  bool has_header_ = false;
  v1::ApplyStyleHeader header_;
  groom::TriangleMesh mesh_;
  BodyUpload bodies_;
};

}  // namespace mane::rpc
