#pragma once

#include <grpcpp/alarm.h>

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "animate_call.h"
#include "export_call.h"
#include "frame_decoder.h"
#include "mane/head.h"
#include "outbox.h"
#include "transport.h"

namespace mane::inline client {

/// The state machine behind a Head: one call at a time, an outbox, a one-slot mailbox for frames.
///
///     Open -> [fetch guides] -> call --opened--> streaming --broken--> pause -> call ...
///                                 \--refused--> closed <--Close(), error--/
///
/// Lifetime: shared by the Head and by what is in flight (calls, timers). Close() returns when
///           nothing is in flight any more, and drops the transport: gRPC joins its threads with
///           the last channel, so that one must not go on a thread of gRPC's.
/// Threads:  the public methods come from any thread, the On*() ones from gRPC's; `mutex_` guards
///           all that is below it and is held for no longer than starting a write takes. gRPC runs
///           no reaction inside StartCall() or StartWrite(), so these are called under the lock.
class HeadStream final : public AnimateCall::Events,
                         public std::enable_shared_from_this<HeadStream> {
 public:
  using FramePtr = std::shared_ptr<const Frame>;
  enum class Motion { kPose, kTeleport };

  HeadStream(std::shared_ptr<Transport> transport, HeadOptions options);

  /// Starts the first try. Called once.
  void Open();

  // The methods of Head.
  Result<void> WaitUntilStreaming(std::chrono::milliseconds timeout);
  Result<void> Push(Motion motion, double time_s, const Pose& pose,
                    const std::vector<BodyPose>& bodies);
  Result<FramePtr> Step(Motion motion, double time_s, const Pose& pose,
                        const std::vector<BodyPose>& bodies);
  Result<void> Reset();
  Result<void> SetEnvironment(const Environment& change);
  Result<void> SetModel(AnimationModel model, const std::optional<BeamMotion>& beam);
  FramePtr NewestFrame();
  HeadStatus Status() const;
  void Close();

  void OnResponse(const v1::AnimateResponse& response) override;
  void OnWritten() override;
  void OnReadsEnded() override;
  void OnCallDone(std::unique_ptr<AnimateCall> call, const grpc::Status& status) override;

 private:
  using Clock = std::chrono::steady_clock;

  void OnExportDone(std::unique_ptr<ExportCall> call, const grpc::Status& status);
  void OnOpened(const v1::Opened& opened);
  void OnFrame(const v1::HairFrame& frame);
  void OnNotice(const v1::Notice& notice);
  void OnAckTimer(bool expired);
  void OnRetryTimer(bool expired);

  // All of these want `mutex_` held.
  void TryLocked();  // Starts the export or the animate call.
  v1::AnimateRequest OpenRequestLocked();
  void PumpLocked();  // Starts the next write if there is one to start.
  void AcknowledgeSoonLocked();
  void HandleBreakLocked(Error error);  // Retries, opens anew or ends.
  void RetryLaterLocked();
  void EndLocked(std::optional<Error> error);
  void CancelCallsLocked();
  Error MissedStepLocked(double time_s);  // Ends the head.
  Result<void> PutLocked(Motion motion, double time_s, const Pose& pose,
                         const std::vector<BodyPose>& bodies);
  Result<void> OpenLocked(Pacing wanted, const char* instead) const;
  std::optional<Error> ClosedLocked() const;

  const HeadOptions options_;
  std::mutex step_mutex_;  // One Step() at a time; taken before `mutex_`.

  mutable std::mutex mutex_;
  std::condition_variable changed_;
  std::shared_ptr<Transport> transport_;  // Null once closed and idle.
  HeadStatus status_;
  int in_flight_ = 0;  // Calls and timers that will still come back.

  // The current call.
  AnimateCall* call_ = nullptr;
  ExportCall* export_ = nullptr;
  bool resuming_ = false;    // It was opened with the token and is not answered yet.
  bool writable_ = false;    // Opened, and its reads have not ended.
  bool writing_ = false;     // A write is under way.
  bool half_close_ = false;  // Nothing but the half-close is to be written any more.

  // Retrying.
  std::optional<Clock::time_point> broken_since_;
  int tries_ = 0;
  std::minstd_rand jitter_;
  std::unique_ptr<grpc::Alarm> retry_timer_;

  // The head on the server.
  bool was_open_ = false;
  std::string request_id_;
  std::string resume_token_;  // Empty when there is no head to go on with.
  std::shared_ptr<const std::vector<GuideGeometry>> guides_;
  std::shared_ptr<const FrameDecoder> decoder_;

  // To the server.
  Outbox outbox_;
  Environment environment_;  // All changes so far, for a head that is opened anew.
  AnimationModel model_;     // The newest, likewise.
  BeamMotion beam_;
  bool model_set_ = false;  // By SetModel().
  Pose last_pose_;
  std::vector<BodyPose> bodies_;  // kRealtime: newest poses of all that were placed.
  double last_time_s_ = -std::numeric_limits<double>::infinity();
  std::unique_ptr<grpc::Alarm> ack_timer_;
  bool ack_due_ = false;
  std::uint64_t acked_ = 0;       // Newest frame that the user took.
  std::uint64_t acked_sent_ = 0;  // The server knows.

  // From the server.
  FramePtr newest_;
  bool newest_is_current_ = false;  // It came from the head that is open now.
  std::uint64_t poses_stepped_ = 0;
  std::uint64_t frames_received_ = 0;
};

}  // namespace mane::inline client
