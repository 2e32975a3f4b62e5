#include "session/head_session.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "base/clock.h"
#include "head/model_switch.h"
#include "session/admission.h"

namespace mane::session {
namespace {

// A real-time head that stood still longer than this (its client was away) goes on from where its
// head is now, rather than moving there in one frame [s].
constexpr double kLongestGap = 0.5;
// Least time between two notices of a kind [s].
constexpr double kNoticePeriod = 1;
// Commands and frames a head may have waiting before its client is read no further; in lockstep
// every command may become a frame.
constexpr int kMaxBacklogLockstep = 8;
constexpr int kMaxBacklogRealtime = 64;

int MaxBacklog(const groom::Groom& groom, const HeadOptions& options) {
  if (options.pacing == Pacing::kRealtime) return kMaxBacklogRealtime;
  return FrameWindow(groom, options.view, kMaxBacklogLockstep);
}

bool MayShed(const HeadOptions& options) {
  return options.may_shed && options.pacing == Pacing::kRealtime &&
         options.view.format != head::FrameFormat::kGeneralized;
}

Mailbox MakeMailbox(const groom::Groom& groom, const HeadOptions& options) {
  if (options.pacing == Pacing::kLockstep) return Mailbox::Ordered();
  return Mailbox::Newest(FrameWindow(groom, options.view, options.max_unacked));
}

}  // namespace

HeadSession::HeadSession(std::string name, Asset asset, const HeadOptions& options,
                         exec::WorkerPool& pool, LevelLibrary& levels, BeamLibrary& beams)
    : name_(std::move(name)),
      asset_(std::move(asset)),
      groom_(asset_.groom),
      bodies_(asset_.bodies),
      options_(options),
      pool_(pool),
      levels_(levels),
      beams_(beams),
      max_backlog_(MaxBacklog(*groom_, options)),
      state_(head::AtRest(*groom_, options.initial_pose)),
      environment_(options.environment),
      wanted_(options.model),
      motion_(bodies_),
      mailbox_(MakeMailbox(*groom_, options)),
      asked_(options.model),
      shown_model_(options.model.model) {
  head::StartContact(*groom_, bodies_, &state_);
  const bool beam = wanted_.model == head::Model::kBeam;
  if (beam || MayShed(options)) prepared_ = beams_.FindOrMake(asset_, wanted_.beam);
  if (beam) head::StartBeams(prepared_, &state_);
}

Result<void> HeadSession::Submit(Command command) {
  const bool lockstep = options_.pacing == Pacing::kLockstep;
  {
    std::lock_guard lock(mutex_);
    if (end_) return Error{ErrorCode::kInternal, "the head has ended", ""};
    if (auto* pose = std::get_if<PoseCommand>(&command)) {
      const char* const field = pose->teleport ? "teleport.time_s" : "pose.time_s";
      if (newest_time_ && !(pose->time - *newest_time_ >= kLeastPoseGap)) {
        return InvalidArgument(field, fmt::format("{} is {}; it must be above the last one, {}, by "
                                                  "at least {} s",
                                                  field, pose->time, *newest_time_, kLeastPoseGap));
      }
      if (lockstep && newest_time_ && !pose->teleport &&
          pose->time - *newest_time_ > kLongestPoseGap) {
        return InvalidArgument(
            field, fmt::format("{} is {}, {} s after the last one; it must be at most {} s "
                               "(send a teleport to leave time out)",
                               field, pose->time, pose->time - *newest_time_, kLongestPoseGap));
      }
      if (lockstep && newest_time_ && !pose->teleport) {
        const auto admitted =
            AdmitFrame(*groom_, {{}, pose->time - *newest_time_, options_.substeps}, asked_);
        if (!admitted) return admitted;
      }
      newest_time_ = pose->time;
      Apply(pose->bodies, &named_);
      pose->bodies = named_;
      if (!lockstep) {
        if (pose->teleport) motion_.Clear();
        motion_.Add(pose->time, pose->pose, base::SteadySeconds(), named_);
      }
    }
    if (const auto* change = std::get_if<ModelCommand>(&command)) asked_ = change->model;
    if (lockstep || !std::holds_alternative<PoseCommand>(command) ||
        std::get<PoseCommand>(command).teleport) {
      commands_.push_back(std::move(command));
    }
    if (!lockstep || running_) return {};
    running_ = true;
  }
  Start(pool_, [this] { RunCommand(); });
  return {};
}

Result<void> HeadSession::Acknowledge(uint64_t index) {
  if (options_.pacing == Pacing::kLockstep) return {};
  std::lock_guard lock(mutex_);
  return mailbox_.Acknowledge(index);
}

OutgoingFrame HeadSession::TakeFrame() {
  std::lock_guard lock(mutex_);
  return mailbox_.Take();
}

int HeadSession::Backlog() const {
  std::lock_guard lock(mutex_);
  return static_cast<int>(commands_.size()) + mailbox_.size() + (in_hand_ ? 1 : 0);
}

uint64_t HeadSession::next_frame() const {
  std::lock_guard lock(mutex_);
  return next_frame_;
}

head::ModelOptions HeadSession::model() const {
  std::lock_guard lock(mutex_);
  return asked_;
}

head::Model HeadSession::shown_model() const {
  std::lock_guard lock(mutex_);
  return shown_model_;
}

void HeadSession::Attach(FrameSink* sink) {
  // Held throughout: an End of now either finds the sink or is found here.
  std::lock_guard sink_lock(sink_mutex_);
  std::optional<Error> end;
  {
    std::lock_guard lock(mutex_);
    mailbox_.Reconnect();
    told_no_poses_at_ = base::SteadySeconds();
    end = end_;
  }
  if (end) {
    sink->OnEnd(*end);
  } else {
    sink_ = sink;
  }
}

void HeadSession::Detach(FrameSink* sink) {
  std::lock_guard lock(sink_mutex_);
  if (sink_ == sink) sink_ = nullptr;
}

void HeadSession::Displace() {
  std::lock_guard lock(sink_mutex_);
  if (FrameSink* sink = std::exchange(sink_, nullptr)) {
    sink->OnEnd({ErrorCode::kCancelled, "another stream resumed this head", ""});
  }
}

void HeadSession::End(const Error& error) {
  {
    std::lock_guard lock(mutex_);
    if (!end_) end_ = error;
    commands_.clear();
  }
  std::lock_guard lock(sink_mutex_);
  if (FrameSink* sink = std::exchange(sink_, nullptr)) sink->OnEnd(error);
}

void HeadSession::Notify(const Notice& notice) {
  std::lock_guard lock(sink_mutex_);
  if (sink_ != nullptr) sink_->OnNotice(notice);
}

template <typename Work>
void HeadSession::Start(exec::WorkerPool& pool, Work work) {
  pool.Post([self = shared_from_this(), work] {
    try {
      work();
    } catch (const std::exception& fault) {
      self->End({ErrorCode::kInternal, fmt::format("{}: {}", self->name_, fault.what()), ""});
      return;  // Nothing touches the state again: `running_` stays set where a task of it failed.
    }
    std::lock_guard lock(self->sink_mutex_);
    if (self->sink_ != nullptr) self->sink_->OnProgress();
  });
}

void HeadSession::PrepareDetail() {
  if (!(environment_.detail_tolerance > 0) || state_.detail.levels || state_.beams.active) return;
  const bool lockstep = options_.pacing == Pacing::kLockstep;
  auto levels = lockstep ? levels_.FindOrMake(groom_) : levels_.Find(groom_);
  if (levels) {
    head::StartDetail(*groom_, std::move(levels), &state_.detail);
  } else if (!std::exchange(levels_ordered_, true)) {
    Start(levels_.pool(), [this] { (void)levels_.FindOrMake(groom_); });
  }
}

BeamLibrary::BeamsPtr HeadSession::PrepareBeams() {
  const bool lockstep = options_.pacing == Pacing::kLockstep;
  {
    std::lock_guard lock(mutex_);
    if (prepared_ != nullptr && prepared_->options == wanted_.beam) return prepared_;
    // One at a time, however often the client changes its mind.
    if (!lockstep && std::exchange(preparing_, true)) return nullptr;
  }
  const auto prepare = [this, beam = wanted_.beam] {
    BeamLibrary::BeamsPtr made = beams_.FindOrMake(asset_, beam);
    std::lock_guard lock(mutex_);
    preparing_ = false;
    prepared_.swap(made);  // Those before go without the lock.
    return prepared_;
  };
  if (lockstep) return prepare();
  Start(beams_.pool(), prepare);
  return nullptr;
}

void HeadSession::PrepareModel(bool shed) {
  const bool stand_in = shed && wanted_.model != head::Model::kBeam;
  const bool beam = stand_in || wanted_.model == head::Model::kBeam;
  BeamLibrary::BeamsPtr beams = beam ? PrepareBeams() : nullptr;
  if (beam && beams == nullptr) return;
  if (beams != state_.beams.beams) {
    if (options_.pacing == Pacing::kRealtime) {
      // It takes as long as dozens of frames, which nobody has reckoned with.
      if (last_due_ - changed_due_ < head::kTransitionTime) return;
      changed_due_ = last_due_;
    }
    head::SwitchModel(*groom_, std::move(beams), options_.view.points_per_guide, &state_, pool_);
  }
  const bool before = std::exchange(shed_, stand_in);
  // Hair that its client wants to be beams meanwhile is as it was asked to be.
  if (before == stand_in || (before && beam)) return;
  Notify({Notice::Code::kModel, 0, beam ? head::Model::kBeam : head::Model::kSuperHelix,
          stand_in ? "frames came late: the hair is animated as BEAM until they no longer do"
                   : "the hair is animated as before frames came late"});
}

void HeadSession::MoveTo(const Target& target, double duration) {
  PrepareDetail();
  const head::Movement movement{target.head, duration, options_.substeps, target.bodies};
  repaired_ += head::Advance(*groom_, movement, environment_, &state_, pool_).repaired_guides;
}

void HeadSession::TeleportTo(Target target) {
  head::Teleport(*groom_, target.head, &state_);
  state_.contact.moving = std::move(target.bodies);
}

std::shared_ptr<Frame> HeadSession::MakeFrame(double time, double newest_pose_time,
                                              double started) {
  auto frame = std::make_shared<Frame>();
  frame->time = time;
  frame->pose = state_.pose;
  frame->data = head::EncodeFrame(*groom_, state_, options_.view, pool_);
  frame->model = state_.beams.active ? head::Model::kBeam : head::Model::kSuperHelix;
  if (options_.diagnostics && !state_.beams.active) {
    frame->diagnostics = head::Diagnose(*groom_, state_, environment_, pool_);
  }
  frame->newest_pose_time = newest_pose_time;
  frame->repaired_guides = std::exchange(repaired_, 0);
  frame->stepped_elements = head::SteppedElements(*groom_, state_);
  frame->step_seconds = base::SteadySeconds() - started;
  return frame;
}

void HeadSession::Show(std::shared_ptr<Frame> frame) {
  frame->index = next_frame_++;
  shown_model_ = frame->model;
  mailbox_.Put(std::move(frame));
}

// --- lockstep ---

void HeadSession::RunCommand() {
  Command command;
  {
    std::lock_guard lock(mutex_);
    if (commands_.empty() || end_) {
      running_ = false;
      return;
    }
    command = std::move(commands_.front());
    commands_.pop_front();
    in_hand_ = true;
  }
  std::shared_ptr<Frame> frame;
  if (const auto* pose = std::get_if<PoseCommand>(&command)) {
    const double started = base::SteadySeconds();
    Target target{pose->pose, PlaceBodies(bodies_.get(), pose->pose, pose->bodies)};
    if (pose->teleport || !placed_) {
      TeleportTo(std::move(target));
      placed_ = true;
    } else {
      MoveTo(target, pose->time - last_pose_time_);
    }
    last_pose_time_ = pose->time;
    frame = MakeFrame(pose->time, pose->time, started);
  } else if (const auto* change = std::get_if<EnvironmentCommand>(&command)) {
    Apply(*change, &environment_);
  } else if (auto* choice = std::get_if<ModelCommand>(&command)) {
    wanted_ = std::move(choice->model);
    PrepareModel(false);
  } else {
    head::Reset(*groom_, &state_);
  }
  {
    std::lock_guard lock(mutex_);
    if (frame) {
      Show(std::move(frame));
    }
    in_hand_ = false;
    running_ = !commands_.empty() && !end_;
    if (!running_) return;
  }
  Start(pool_, [this] { RunCommand(); });  // Behind the heads that wait already.
}

// --- real time ---

void HeadSession::Tick(double due, int missed) {
  const double now = base::SteadySeconds();
  {
    std::lock_guard lock(mutex_);
    if (end_) return;
    late_ += missed;
    shedding_.Late(now, missed + (running_ ? 1 : 0));
    if (running_) {
      ++late_;
      return;
    }
    running_ = true;
  }
  Start(pool_, [this, due, now] { RunTick(due, now); });
}

std::optional<HeadSession::Target> HeadSession::RealtimeTarget(double due, double* time,
                                                               double* newest_pose_time) {
  if (motion_.empty()) return std::nullopt;
  // What is shown is never older than the first pose.
  *time = std::max(motion_.oldest_time(), motion_.ClientTime(due) - options_.pose_delay);
  // Never back, even when the estimate of the client's clock is corrected.
  if (placed_) *time = std::max(shown_time_, *time);
  *newest_pose_time = motion_.newest_time();
  return Target{motion_.At(*time), motion_.BodiesAt(*time)};
}

void HeadSession::RunTick(double due, double now) {
  const double started = base::SteadySeconds();
  std::deque<Command> commands;
  std::optional<Target> target;
  double time = 0, newest_pose_time = 0;
  bool shed = false;
  {
    std::lock_guard lock(mutex_);
    shed = shedding_.Update(now) && MayShed(options_);
    commands.swap(commands_);
    target = RealtimeTarget(due, &time, &newest_pose_time);
  }
  const double elapsed = last_due_ < 0 ? 0 : due - last_due_;
  last_due_ = due;
  bool jump = elapsed > std::max(kLongestGap, 3 / options_.rate_hz) || (target && !placed_);
  for (const Command& command : commands) {
    if (std::holds_alternative<ResetCommand>(command)) head::Reset(*groom_, &state_);
    if (const auto* change = std::get_if<EnvironmentCommand>(&command))
      Apply(*change, &environment_);
    if (const auto* choice = std::get_if<ModelCommand>(&command)) wanted_ = choice->model;
    jump = jump || std::holds_alternative<PoseCommand>(command);
  }
  if (target) {
    if (jump) TeleportTo(*target);
    placed_ = true;
  }
  PrepareModel(shed);
  if (elapsed > 0 && !jump) MoveTo(target.value_or(Target{state_.pose, {}}), elapsed);
  shown_time_ = time;
  auto frame = MakeFrame(time, newest_pose_time, started);
  {
    std::lock_guard lock(mutex_);
    Show(std::move(frame));
    running_ = false;
  }
  NotifyLateness(now);
}

void HeadSession::NotifyLateness(double now) {
  std::optional<Notice> late, no_poses;
  {
    std::lock_guard lock(mutex_);
    if (late_ > 0 && now - told_late_at_ >= kNoticePeriod) {
      late = Notice{Notice::Code::kLate, std::exchange(late_, 0)};
      told_late_at_ = now;
    }
    const double silent_since =
        motion_.empty() ? told_no_poses_at_ : std::max(told_no_poses_at_, motion_.newest_arrival());
    if (now - silent_since > kNoticePeriod) {
      no_poses = Notice{Notice::Code::kNoPoses, 0};
      told_no_poses_at_ = now + 9 * kNoticePeriod;  // Once in ten seconds.
    }
  }
  if (late) Notify(*late);
  if (no_poses) Notify(*no_poses);
}

}  // namespace mane::session
