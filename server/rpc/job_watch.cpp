#include "rpc/job_watch.h"

#include <utility>

#include "rpc/job_service.h"
#include "rpc/names.h"
#include "rpc/status.h"

namespace mane::rpc {

JobWatch* JobWatch::Start(jobs::Queue& queue, const std::string& name) {
  auto* watch = new JobWatch();
  const auto id = ParseName(name, "jobs", "name");
  std::lock_guard lock(watch->mutex_);
  if (!id) {
    watch->CloseLocked(ToStatus(id.error()));
  } else {
    watch->subscription_ =
        queue.Watch(*id, [watch](const Result<jobs::JobStatus>& status) { watch->Show(status); });
  }
  return watch;
}

void JobWatch::Show(const Result<jobs::JobStatus>& status) {
  std::lock_guard lock(mutex_);
  if (!status) return CloseLocked(ToStatus(status.error()));
  FromStatus(*status, &newest_.emplace());
  ended_ = storage::HasEnded(status->job.state);
  WriteOnLocked();
}

void JobWatch::OnWriteDone(bool ok) {
  std::lock_guard lock(mutex_);
  writing_ = false;
  if (!ok) return CloseLocked(grpc::Status::CANCELLED);
  WriteOnLocked();
}

void JobWatch::OnCancel() {
  std::lock_guard lock(mutex_);
  CloseLocked(grpc::Status::CANCELLED);
}

void JobWatch::OnDone() {
  subscription_.Reset();
  delete this;
}

void JobWatch::WriteOnLocked() {
  if (writing_ || finished_) return;
  if (newest_) {
    outgoing_ = *std::exchange(newest_, std::nullopt);
    writing_ = true;
    StartWrite(&outgoing_);
  } else if (ended_) {
    CloseLocked(grpc::Status::OK);
  }
}

void JobWatch::CloseLocked(const grpc::Status& status) {
  if (std::exchange(finished_, true)) return;
  Finish(status);
}

}  // namespace mane::rpc
