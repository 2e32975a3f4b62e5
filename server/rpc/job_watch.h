#pragma once

#include <grpcpp/grpcpp.h>

#include <mutex>
#include <optional>
#include <string>

#include "jobs/queue.h"
#include "mane/v1/job.pb.h"

namespace mane::rpc {

/// One WatchJob call: the job as it is, then after every change, until it has ended. A client
/// slower than the changes sees the newest.
///
/// Lifetime: owns itself until OnDone(), which ends the subscription and waits for a running
/// callback. Threads:  the callback runs on the queue's watcher thread, reactions on gRPC's;
/// `mutex_` guards
///           what stands below it.
class JobWatch final : public grpc::ServerWriteReactor<v1::Job> {
 public:
  static JobWatch* Start(jobs::Queue& queue, const std::string& name);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  JobWatch() = default;
  void Show(const Result<jobs::JobStatus>& status);
  void CloseLocked(const grpc::Status& status);
  void WriteOnLocked();

  std::mutex mutex_;
  std::optional<v1::Job> newest_;  // Not yet written.
  v1::Job outgoing_;               // gRPC reads it until OnWriteDone().
  bool writing_ = false;
  bool ended_ = false;     // `newest_` or what was written shows the job's end.
  bool finished_ = false;  // Finish() was called.

  jobs::Subscription subscription_;
};

}  // namespace mane::rpc
