#include "head_stream.h"

#include <fmt/format.h>
#include <grpc/support/time.h>

#include <algorithm>
#include <utility>

#include "convert.h"
#include "status.h"

namespace mane::inline client {
namespace {

using std::chrono::milliseconds;

// A pose that follows a poll within this time carries the acknowledgement; a little more than one
// interval of a 60 Hz game.
constexpr milliseconds kAckDelay{20};
constexpr milliseconds kFirstRetry{50};
constexpr milliseconds kLongestRetry{2000};
// How long Close() lets the server end the stream by itself, which frees the head at once.
constexpr milliseconds kCloseGrace{250};

bool IsRetryable(ErrorCode code) {
  return code == ErrorCode::kUnavailable || code == ErrorCode::kCancelled ||
         code == ErrorCode::kUnknown;
}

std::string RandomId() {
  std::random_device random;
  return fmt::format("{:08x}{:08x}{:08x}{:08x}", random(), random(), random(), random());
}

gpr_timespec After(milliseconds delay) {
  return gpr_time_add(gpr_now(GPR_CLOCK_MONOTONIC),
                      gpr_time_from_millis(delay.count(), GPR_TIMESPAN));
}

}  // namespace

HeadStream::HeadStream(std::shared_ptr<Transport> transport, HeadOptions options)
    : options_(std::move(options)),
      transport_(std::move(transport)),
      jitter_(std::random_device{}()),
      request_id_(RandomId()),
      environment_(options_.environment),
      model_(options_.model),
      beam_(options_.beam),
      last_pose_(options_.initial_pose) {}

void HeadStream::Open() {
  std::lock_guard lock(mutex_);
  TryLocked();
}

// ---- Calls of the user.

Result<void> HeadStream::WaitUntilStreaming(milliseconds timeout) {
  std::unique_lock lock(mutex_);
  const bool settled = changed_.wait_for(lock, timeout, [this] {
    return status_.state == HeadState::kStreaming || status_.state == HeadState::kClosed;
  });
  if (settled) {
    if (auto closed = ClosedLocked()) return *closed;
    return {};
  }
  const std::string reason = status_.error ? ": " + status_.error->message : "";
  return Error{ErrorCode::kDeadlineExceeded,
               fmt::format("not streaming after {} ms{}", timeout.count(), reason), ""};
}

Result<void> HeadStream::Push(Motion motion, double time_s, const Pose& pose,
                              const std::vector<BodyPose>& bodies) {
  std::lock_guard lock(mutex_);
  if (auto open = OpenLocked(Pacing::kRealtime, "Step() or StepTeleport()"); !open) return open;
  if (auto put = PutLocked(motion, time_s, pose, bodies); !put) return put;
  PumpLocked();
  return {};
}

Result<HeadStream::FramePtr> HeadStream::Step(Motion motion, double time_s, const Pose& pose,
                                              const std::vector<BodyPose>& bodies) {
  std::lock_guard one_at_a_time(step_mutex_);
  std::unique_lock lock(mutex_);
  const auto deadline = Clock::now() + options_.step_timeout;
  if (auto open = OpenLocked(Pacing::kLockstep, "PushPose() or Teleport()"); !open) {
    return open.error();
  }
  const auto settled = [this] { return status_.state != HeadState::kConnecting; };
  if (!changed_.wait_until(lock, deadline, settled)) return MissedStepLocked(time_s);
  if (auto closed = ClosedLocked()) return *closed;

  if (auto put = PutLocked(motion, time_s, pose, bodies); !put) return put.error();
  ++poses_stepped_;
  PumpLocked();
  changed_.wait_until(lock, deadline, [this] {
    return frames_received_ == poses_stepped_ || status_.state == HeadState::kClosed;
  });
  if (frames_received_ == poses_stepped_) {
    acked_ = newest_->index;
    return newest_;
  }
  if (auto closed = ClosedLocked()) return *closed;
  return MissedStepLocked(time_s);
}

Error HeadStream::MissedStepLocked(double time_s) {
  Error error{ErrorCode::kDeadlineExceeded,
              fmt::format("no frame for time_s = {} within {} ms; the head is closed", time_s,
                          options_.step_timeout.count()),
              ""};
  EndLocked(error);
  CancelCallsLocked();
  return error;
}

Result<void> HeadStream::Reset() {
  std::lock_guard lock(mutex_);
  if (auto closed = ClosedLocked()) return *closed;
  outbox_.PutReset();
  PumpLocked();
  return {};
}

Result<void> HeadStream::SetEnvironment(const Environment& change) {
  std::lock_guard lock(mutex_);
  if (auto closed = ClosedLocked()) return *closed;
  Merge(change, environment_);
  outbox_.PutEnvironment(change);
  PumpLocked();
  return {};
}

Result<void> HeadStream::SetModel(AnimationModel model, const std::optional<BeamMotion>& beam) {
  std::lock_guard lock(mutex_);
  if (auto closed = ClosedLocked()) return *closed;
  model_ = model;
  model_set_ = true;
  if (beam) beam_ = *beam;
  outbox_.PutModel(model, beam);
  PumpLocked();
  return {};
}

HeadStream::FramePtr HeadStream::NewestFrame() {
  std::lock_guard lock(mutex_);
  if (newest_ && newest_is_current_) {
    acked_ = newest_->index;
    AcknowledgeSoonLocked();
  }
  return newest_;
}

HeadStatus HeadStream::Status() const {
  std::lock_guard lock(mutex_);
  return status_;
}

void HeadStream::Close() {
  std::unique_lock lock(mutex_);
  EndLocked(std::nullopt);
  if (writable_) {
    half_close_ = true;
    PumpLocked();
    changed_.wait_for(lock, kCloseGrace, [this] { return in_flight_ == 0; });
  }
  CancelCallsLocked();
  changed_.wait(lock, [this] { return in_flight_ == 0; });
  const auto transport = std::move(transport_);
  lock.unlock();
}

// ---- What the state allows.

std::optional<Error> HeadStream::ClosedLocked() const {
  if (status_.state != HeadState::kClosed) return std::nullopt;
  return status_.error.value_or(
      Error{ErrorCode::kFailedPrecondition, "the head was closed by Close()", ""});
}

Result<void> HeadStream::OpenLocked(Pacing wanted, const char* instead) const {
  if (auto closed = ClosedLocked()) return *closed;
  if (options_.pacing == wanted) return {};
  return Error{ErrorCode::kFailedPrecondition,
               fmt::format("the head's pacing wants {} instead", instead), "pacing"};
}

Result<void> HeadStream::PutLocked(Motion motion, double time_s, const Pose& pose,
                                   const std::vector<BodyPose>& bodies) {
  if (!(time_s > last_time_s_)) {
    return Error{
        ErrorCode::kInvalidArgument,
        fmt::format("time_s = {} must be greater than the last pose's {}", time_s, last_time_s_),
        "time_s"};
  }
  last_time_s_ = time_s;
  last_pose_ = pose;
  // In real time a pose may replace another before it is sent, and a head be opened anew: each says
  // where all bodies are that any has placed.
  const bool realtime = options_.pacing == Pacing::kRealtime;
  if (realtime) Merge(bodies, bodies_);
  const std::vector<BodyPose>& named = realtime ? bodies_ : bodies;
  if (motion == Motion::kPose) {
    outbox_.PutPose(time_s, pose, named);
  } else {
    outbox_.PutTeleport(time_s, pose, named);
  }
  return {};
}

void HeadStream::EndLocked(std::optional<Error> error) {
  if (status_.state == HeadState::kClosed) return;
  status_.state = HeadState::kClosed;
  status_.error = std::move(error);
  if (ack_timer_) ack_timer_->Cancel();
  if (retry_timer_) retry_timer_->Cancel();
  changed_.notify_all();
}

void HeadStream::CancelCallsLocked() {
  if (call_) call_->Cancel();
  if (export_) export_->Cancel();
}

// ---- Opening and retrying.

void HeadStream::TryLocked() {
  ++in_flight_;
  if (options_.format == FrameFormat::kGeneralized && !guides_) {
    export_ = ExportCall::Start(
        *transport_, options_.groom,
        [self = shared_from_this()](std::unique_ptr<ExportCall> call, const grpc::Status& status) {
          self->OnExportDone(std::move(call), status);
        });
    return;
  }
  resuming_ = !resume_token_.empty();
  writing_ = true;
  call_ = AnimateCall::Start(*transport_, shared_from_this(), OpenRequestLocked());
}

v1::AnimateRequest HeadStream::OpenRequestLocked() {
  v1::AnimateRequest request;
  request.set_acked_frame(acked_);
  v1::OpenHead& open = *request.mutable_open();
  if (resuming_) {
    open.set_resume(resume_token_);
  } else {
    open = ToProto(options_);
    *open.mutable_initial_pose() = ToProto(last_pose_);
    *open.mutable_environment() = ToProto(environment_);
    open.set_model(static_cast<v1::AnimationModel>(model_));
    *open.mutable_beam() = ToProto(beam_);
    open.set_request_id(request_id_);
  }
  return request;
}

void HeadStream::HandleBreakLocked(Error error) {
  if (error.code == ErrorCode::kNotFound && resuming_) {  // The server forgot the head.
    resume_token_.clear();
    request_id_ = RandomId();
    newest_is_current_ = false;
    acked_ = acked_sent_ = 0;
    TryLocked();
    return;
  }
  const auto now = Clock::now();
  if (!broken_since_) broken_since_ = now;
  const bool retry = options_.pacing == Pacing::kRealtime && IsRetryable(error.code) &&
                     now - *broken_since_ < options_.reconnect_timeout;
  if (!retry) {
    EndLocked(std::move(error));
    return;
  }
  status_.state = was_open_ ? HeadState::kReconnecting : HeadState::kConnecting;
  status_.error = std::move(error);
  RetryLaterLocked();
}

void HeadStream::RetryLaterLocked() {
  const milliseconds longest = std::min(kLongestRetry, kFirstRetry * (1 << std::min(tries_++, 10)));
  std::uniform_int_distribution<milliseconds::rep> pause(longest.count() / 2, longest.count());
  ++in_flight_;
  retry_timer_ = std::make_unique<grpc::Alarm>();
  retry_timer_->Set(After(milliseconds(pause(jitter_))),
                    [self = shared_from_this()](bool expired) { self->OnRetryTimer(expired); });
}

void HeadStream::OnRetryTimer(bool expired) {
  std::lock_guard lock(mutex_);
  retry_timer_.reset();  // It holds a reference to this.
  if (expired && status_.state != HeadState::kClosed) TryLocked();
  --in_flight_;
  changed_.notify_all();
}

void HeadStream::OnExportDone(std::unique_ptr<ExportCall> call, const grpc::Status& status) {
  std::unique_lock lock(mutex_);
  export_ = nullptr;
  if (status_.state != HeadState::kClosed) {
    if (status.ok()) {
      guides_ = std::make_shared<const std::vector<GuideGeometry>>(call->TakeGuides());
      TryLocked();
    } else {
      Error error = ToError(status);
      if (error.field == "name") error.field = "open.groom";  // As Animate calls it.
      HandleBreakLocked(std::move(error));
    }
  }
  lock.unlock();
  call.reset();
  lock.lock();
  --in_flight_;
  changed_.notify_all();
}

void HeadStream::OnCallDone(std::unique_ptr<AnimateCall> call, const grpc::Status& status) {
  std::unique_lock lock(mutex_);
  call_ = nullptr;
  writable_ = writing_ = false;
  if (status_.state != HeadState::kClosed) {
    HandleBreakLocked(status.ok()
                          ? Error{ErrorCode::kUnavailable, "the server ended the stream", ""}
                          : ToError(status));
  }
  lock.unlock();
  call.reset();
  lock.lock();
  --in_flight_;
  changed_.notify_all();
}

// ---- Writing.

void HeadStream::PumpLocked() {
  if (!writable_ || writing_) return;
  if (half_close_) {
    writable_ = false;
    call_->HalfClose();
    return;
  }
  if (outbox_.empty() && !ack_due_) return;
  v1::AnimateRequest request;
  if (outbox_.empty()) {
    request.mutable_acknowledge();
  } else {
    request = outbox_.Take();
  }
  request.set_acked_frame(acked_);
  acked_sent_ = acked_;
  ack_due_ = false;
  writing_ = true;
  call_->Write(std::move(request));
}

void HeadStream::OnWritten() {
  std::lock_guard lock(mutex_);
  writing_ = false;
  PumpLocked();
}

void HeadStream::OnReadsEnded() {
  std::lock_guard lock(mutex_);
  writable_ = false;
}

void HeadStream::AcknowledgeSoonLocked() {
  if (acked_ == acked_sent_ || ack_timer_ || !writable_) return;
  ++in_flight_;
  ack_timer_ = std::make_unique<grpc::Alarm>();
  ack_timer_->Set(After(kAckDelay),
                  [self = shared_from_this()](bool expired) { self->OnAckTimer(expired); });
}

void HeadStream::OnAckTimer(bool expired) {
  std::lock_guard lock(mutex_);
  ack_timer_.reset();  // It holds a reference to this.
  if (expired && acked_ != acked_sent_) {
    ack_due_ = true;
    PumpLocked();
  }
  --in_flight_;
  changed_.notify_all();
}

// ---- Reading.

void HeadStream::OnResponse(const v1::AnimateResponse& response) {
  switch (response.kind_case()) {
    case v1::AnimateResponse::kOpened:
      return OnOpened(response.opened());
    case v1::AnimateResponse::kFrame:
      return OnFrame(response.frame());
    case v1::AnimateResponse::kNotice:
      return OnNotice(response.notice());
    case v1::AnimateResponse::KIND_NOT_SET:
      return;  // A kind that a newer server knows.
  }
}

void HeadStream::OnOpened(const v1::Opened& opened) {
  std::lock_guard lock(mutex_);
  if (status_.state == HeadState::kClosed) return;
  auto decoder = FrameDecoder::Create(opened, guides_);
  if (!decoder) {
    EndLocked(decoder.error());
    CancelCallsLocked();
    return;
  }
  decoder_ = *decoder;
  resume_token_ = opened.resume_token();
  if (resuming_) {
    ++status_.resumes;
    outbox_.PutEnvironment(environment_);  // A change may have been lost on its way.
    if (model_set_) outbox_.PutModel(model_, beam_);
  } else if (was_open_) {
    ++status_.reopenings;
  }
  resuming_ = false;
  was_open_ = true;
  broken_since_.reset();
  tries_ = 0;
  status_.state = HeadState::kStreaming;
  status_.error.reset();
  status_.server_draining = false;
  acked_sent_ = 0;
  ack_due_ = false;
  writable_ = true;
  PumpLocked();
  changed_.notify_all();
}

void HeadStream::OnFrame(const v1::HairFrame& message) {
  std::shared_ptr<const FrameDecoder> decoder;
  {
    std::lock_guard lock(mutex_);
    decoder = decoder_;
  }
  Result<FramePtr> frame =
      decoder ? decoder->Decode(message)
              : Error{ErrorCode::kInternal, "the server sent a frame before `opened`", ""};

  std::lock_guard lock(mutex_);
  if (status_.state == HeadState::kClosed) return;
  if (!frame) {
    EndLocked(frame.error());
    CancelCallsLocked();
    return;
  }
  if (newest_is_current_ && (*frame)->index <= newest_->index) return;  // Sent again.
  newest_ = *std::move(frame);
  newest_is_current_ = true;
  ++frames_received_;
  changed_.notify_all();
}

void HeadStream::OnNotice(const v1::Notice& notice) {
  std::lock_guard lock(mutex_);
  if (notice.code() == v1::Notice::CODE_LATE) status_.missed_deadlines += notice.count();
  if (notice.code() == v1::Notice::CODE_DRAINING) status_.server_draining = true;
}

}  // namespace mane::inline client
