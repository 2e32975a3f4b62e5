#pragma once

#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "base/result.h"
#include "exec/worker_pool.h"
#include "groom/groom.h"
#include "session/asset.h"
#include "session/beam_library.h"
#include "session/command.h"
#include "session/frame.h"
#include "session/level_library.h"
#include "session/mailbox.h"
#include "session/motion_buffer.h"
#include "session/shedding.h"

namespace mane::session {

/// Something a client should know; see the proto's Notice.
struct Notice {
  enum class Code { kLate, kDraining, kNoPoses, kModel };
  Code code;
  uint64_t count = 0;
  head::Model model = head::Model::kSuperHelix;  ///< kModel: which the head has,
  std::string why = {};                          ///< and why.
};

/// The stream that a head's frames go to. Called from workers and the scheduler, possibly at once;
/// must not block, and must not call HeadSession::Detach.
class FrameSink {
 public:
  virtual ~FrameSink() = default;
  /// HeadSession::TakeFrame may have something, or there is room for more commands.
  virtual void OnProgress() = 0;
  virtual void OnNotice(const Notice& notice) = 0;
  /// The head is gone (a fault of its own, or replaced); nothing follows.
  virtual void OnEnd(const Error& error) = 0;
};

/// One animated head: its state, what its client wants of it, and the frames that result.
///
/// Ownership: shared by the registry, the client's stream and the task that advances it.
/// Threads:   every method from any thread. `mutex_` guards what stands below it and is held for
///            moments only; the state and environment belong to the one task that runs
///            (`running_`). `sink_mutex_` is held while the sink is called, so that Detach returns
///            only when no call is under way; it is never taken under `mutex_`.
class HeadSession : public std::enable_shared_from_this<HeadSession> {
 public:
  HeadSession(std::string name, Asset asset, const HeadOptions& options, exec::WorkerPool& pool,
              LevelLibrary& levels, BeamLibrary& beams);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] const groom::Groom& groom() const { return *groom_; }
  [[nodiscard]] const HeadOptions& options() const { return options_; }
  /// What the client last asked for.
  [[nodiscard]] head::ModelOptions model() const;
  /// What the newest frame was computed with, which may be another while it is prepared or shed.
  [[nodiscard]] head::Model shown_model() const;

  /// Hands over what the client sent. kInvalidArgument for a pose whose time does not increase or
  /// (lockstep) is more than a second after the one before.
  Result<void> Submit(Command command);
  /// See Mailbox::Acknowledge; no effect in lockstep.
  Result<void> Acknowledge(uint64_t index);
  /// The next frame to send, if any.
  [[nodiscard]] OutgoingFrame TakeFrame();
  /// Commands not yet worked off and frames not yet sent.
  [[nodiscard]] int Backlog() const;
  /// So many of them that the client must be read no further for now: a few in lockstep, fewer
  /// where frames are large.
  [[nodiscard]] bool Full() const { return Backlog() >= max_backlog_; }
  [[nodiscard]] uint64_t next_frame() const;

  /// Directs frames to `sink`, until Detach. A head without a sink stands still. A head that has
  /// ended tells the sink at once.
  void Attach(FrameSink* sink);
  /// Returns when no call of `sink` is under way; none follows. Nothing if another one took over.
  void Detach(FrameSink* sink);
  /// Another stream takes over: tells the sink, if there is one, and detaches it.
  void Displace();
  /// Ends the head: tells its sink, which is detached.
  void End(const Error& error);
  void Notify(const Notice& notice);

  /// Real time: makes the frame that is due at server time `due` [s], `missed` ticks having been
  /// passed over before. Does nothing but count if the one before is still being computed.
  void Tick(double due, int missed);

 private:
  void RunTick(double due, double now);
  // Lockstep: one command, then to the end of the pool's line: a client that always has more keeps
  // no worker from other heads.
  void RunCommand();
  // Runs `work` on `pool` and tells the sink; a failed check ends the head.
  template <typename Work>
  void Start(exec::WorkerPool& pool, Work work);

  // Gives the state its levels of detail, where they are wanted. Lockstep makes them if need be, so
  // that they act from the first frame with a tolerance on, always. Real time goes on without until
  // they have been made elsewhere.
  void PrepareDetail();
  // Changes the state's model to what the client wants, or to beams while they are shed to; in real
  // time once beams are there and the change before is over.
  void PrepareModel(bool shed);
  // The beams that the client last described, where they are there. Lockstep makes them if need be.
  [[nodiscard]] BeamLibrary::BeamsPtr PrepareBeams();
  struct Target {
    math::Pose head;
    std::vector<math::Pose> bodies;  // (moving_count)
  };
  void MoveTo(const Target& target, double duration);
  void TeleportTo(Target target);
  // The next frame. `mutex_` is held.
  void Show(std::shared_ptr<Frame> frame);
  std::shared_ptr<Frame> MakeFrame(double time, double newest_pose_time, double started);
  void NotifyLateness(double now);
  [[nodiscard]] std::optional<Target> RealtimeTarget(double due, double* time,
                                                     double* newest_pose_time);

  const std::string name_;
  const Asset asset_;
  const std::shared_ptr<const groom::Groom> groom_;
  const std::shared_ptr<const head::Bodies> bodies_;  // Null for none.
  const HeadOptions options_;
  exec::WorkerPool& pool_;
  LevelLibrary& levels_;
  BeamLibrary& beams_;
  const int max_backlog_;

  // Owned by the running task.
  head::HeadState state_;
  head::Environment environment_;
  double last_due_ = -1;       // Real time: server time of the frame before; < 0 before the first.
  double last_pose_time_ = 0;  // Lockstep: client time of the state.
  double shown_time_ = 0;      // Client time of the last frame, once placed.
  int repaired_ = 0;
  bool placed_ = false;                          // The first pose has come.
  bool levels_ordered_ = false;                  // Real time: a task makes them, or has made them.
  head::ModelOptions wanted_;                    // Of commands that were worked off.
  bool shed_ = false;                            // Beams stand in for what is wanted.
  double changed_due_ = -head::kTransitionTime;  // Real time: `last_due_` as the model changed.

  mutable std::mutex mutex_;
  bool running_ = false;          // A task works or waits for its turn.
  bool in_hand_ = false;          // Lockstep: it works off a command, which is in neither queue.
  std::optional<Error> end_;      // Why, once the head has ended.
  std::deque<Command> commands_;  // Lockstep: all; real time: all but plain poses.
  MotionBuffer motion_;           // Real time.
  BodyPoses named_;               // Newest pose of every body that any pose has named.
  std::optional<double> newest_time_;  // Client time of the newest pose.
  Mailbox mailbox_;
  uint64_t next_frame_ = 1;
  head::ModelOptions asked_;        // The newest, of commands that wait, too.
  head::Model shown_model_;         // Of the newest frame.
  BeamLibrary::BeamsPtr prepared_;  // Those made last.
  bool preparing_ = false;          // Real time: a task makes others.
  Shedding shedding_;
  uint64_t late_ = 0;  // Missed ticks not yet told.
  double told_late_at_ = 0;
  double told_no_poses_at_ = 0;

  std::mutex sink_mutex_;
  FrameSink* sink_ = nullptr;
};

}  // namespace mane::session
