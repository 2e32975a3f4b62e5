#include "rpc/uploads.h"

#include <grpcpp/alarm.h>

#include <chrono>
#include <memory>
#include <mutex>
#include <utility>

#include "base/clock.h"
#include "rpc/status.h"

namespace mane::rpc {

// Reads an upload message by message. Owned by itself until OnDone(), and by its timer.
class Uploads::Call final : public grpc::ServerReadReactor<grpc::ByteBuffer>,
                            public std::enable_shared_from_this<Call> {
 public:
  Call(Uploads& uploads, std::unique_ptr<Upload> upload, grpc::ByteBuffer* response)
      : uploads_(uploads), upload_(std::move(upload)), response_(response) {}

  void Begin() {
    self_ = shared_from_this();
    {
      std::lock_guard lock(mutex_);
      SetTimer(uploads_.limits_.max_idle_s);
    }
    Read();
  }

  void OnReadDone(bool ok) override {
    {
      std::lock_guard lock(mutex_);
      if (phase_ == Phase::kEnded) return;
      phase_ = Phase::kWorking;
    }
    // Checking and solving are work for a worker; the next read starts when it is done.
    uploads_.solving_.Post([this, ok] {
      try {
        if (ok) {
          Take();
        } else {
          End(ToStatus(InvalidArgument("commit", "the upload ended without commit")));
        }
      } catch (const std::exception& fault) {
        End(ToStatus(Error{ErrorCode::kInternal, fault.what(), ""}));
      }
    });
  }
  void OnCancel() override { cancelled_ = true; }
  void OnDone() override {
    --uploads_.under_way_;
    const std::shared_ptr<Call> self = std::move(self_);
    std::unique_ptr<grpc::Alarm> timer;  // Its end releases the share in this call that it holds.
    std::lock_guard lock(mutex_);
    timer = std::move(timer_);
  }

 private:
  enum class Phase { kWaiting, kWorking, kEnded };

  void Read() {
    {
      std::lock_guard lock(mutex_);
      phase_ = Phase::kWaiting;
      waiting_since_ = base::SteadySeconds();
    }
    StartRead(&incoming_);
  }

  void Take() {
    const Result<bool> last = upload_->Add(&incoming_);
    if (!last) return End(ToStatus(last.error()));
    if (*last) return Complete();
    Read();
  }

  void Complete() {
    if (cancelled_) return End(grpc::Status::CANCELLED);
    const auto answer = upload_->Finish(cancelled_);
    if (!answer) return End(ToStatus(answer.error()));
    *response_ = *answer;
    End(grpc::Status::OK);
  }

  // Called once for each call: by the worker that has its message, or by the timer while none has.
  void End(const grpc::Status& status) {
    {
      std::lock_guard lock(mutex_);
      phase_ = Phase::kEnded;
    }
    Finish(status);
  }

  // Under mutex_. One timer at a time; what came in between puts it off when it fires.
  void SetTimer(double seconds) {
    timer_ = std::make_unique<grpc::Alarm>();
    timer_->Set(std::chrono::system_clock::now() + std::chrono::ceil<std::chrono::microseconds>(
                                                       std::chrono::duration<double>(seconds)),
                [call = shared_from_this()](bool fired) {
                  if (fired) call->OnTimer();
                });
  }

  void OnTimer() {
    const double most = uploads_.limits_.max_idle_s;
    {
      std::lock_guard lock(mutex_);
      if (phase_ == Phase::kEnded) return;
      const double idle = phase_ == Phase::kWaiting ? base::SteadySeconds() - waiting_since_ : 0;
      if (idle < most) return SetTimer(most - idle);
      phase_ = Phase::kEnded;
    }
    Finish({grpc::StatusCode::DEADLINE_EXCEEDED,
            fmt::format("no message of the upload came for {} s; send it again without pauses",
                        most)});
  }

  Uploads& uploads_;
  const std::unique_ptr<Upload> upload_;
  grpc::ByteBuffer incoming_;
  grpc::ByteBuffer* const response_;
  std::atomic<bool> cancelled_ = false;
  std::shared_ptr<Call> self_;

  std::mutex mutex_;
  Phase phase_ = Phase::kWaiting;
  double waiting_since_ = base::SteadySeconds();
  std::unique_ptr<grpc::Alarm> timer_;
};

class Uploads::Refusal final : public grpc::ServerReadReactor<grpc::ByteBuffer> {
 public:
  explicit Refusal(const Error& error) { Finish(ToStatus(error)); }
  void OnDone() override { delete this; }
};

grpc::ServerReadReactor<grpc::ByteBuffer>* Uploads::Start(std::unique_ptr<Upload> upload,
                                                          grpc::ByteBuffer* response) {
  if (++under_way_ > limits_.max_uploads) {
    --under_way_;
    return new Refusal({ErrorCode::kResourceExhausted,
                        fmt::format("{} uploads are under way, as many as this server takes at "
                                    "once; try again when one has ended",
                                    limits_.max_uploads),
                        ""});
  }
  const auto call = std::make_shared<Call>(*this, std::move(upload), response);
  call->Begin();
  return call.get();
}

}  // namespace mane::rpc
