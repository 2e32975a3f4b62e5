#pragma once

#include <deque>
#include <memory>
#include <utility>
#include <vector>

#include "math/rigid.h"
#include "session/body_poses.h"

namespace mane::session {

/// The recent poses of one head and its moving bodies, and what the client's clock shows.
///
/// Client and server clocks share no origin. A pose stamped t that arrives at server time a bounds
/// their difference: a - t is the difference plus the delay on the way, so the smallest a - t of
/// the recent poses is the difference plus the shortest delay. Server time minus that is "now" for
/// the client as well as the server can know it; jitter does not move it, and drift or a jump of
/// the client's clock is followed within kMemory poses.
///
/// Threads: none of its own; guarded by its owner.
class MotionBuffer {
 public:
  static constexpr int kMemory = 128;               ///< Poses kept.
  static constexpr double kMaxExtrapolation = 0.1;  ///< [s] beyond the newest pose.
  /// A speed is taken over at least this long [s]: noise in two poses at nearly one time is none.
  static constexpr double kBaseline = 0.01;

  /// @param bodies  of the head; null for none.
  explicit MotionBuffer(std::shared_ptr<const head::Bodies> bodies = nullptr)
      : bodies_(std::move(bodies)) {}

  /// Adds a pose of client time `time` [s], later than all before, received at server time
  /// `arrival`; `bodies` are all that were named until then.
  void Add(double time, const math::Pose& pose, double arrival, BodyPoses bodies = {});
  /// Forgets all poses: motion before a jump says nothing about motion after it.
  void Clear() { poses_.clear(); }

  [[nodiscard]] bool empty() const { return poses_.empty(); }
  [[nodiscard]] double oldest_time() const { return poses_.front().time; }
  [[nodiscard]] double newest_time() const { return poses_.back().time; }
  [[nodiscard]] double newest_arrival() const { return poses_.back().arrival; }

  /// The client's clock at server time `now`. There must be a pose.
  [[nodiscard]] double ClientTime(double now) const;

  /// The pose at client time `time`: between poses, interpolated; before the first, the first;
  /// after the newest, carried on at its speed since the latest pose that is kBaseline older, for
  /// at most kMaxExtrapolation, then held. There must be a pose.
  [[nodiscard]] math::Pose At(double time) const;

  /// World poses of all moving bodies at client time `time`, likewise. One that was not named
  /// before or after that time is at rest on the head; one that was named first in between is on
  /// the way from there.
  [[nodiscard]] std::vector<math::Pose> BodiesAt(double time) const;

 private:
  struct TimedPose {
    double time;
    double arrival;
    math::Pose pose;
    BodyPoses bodies;
  };
  // The way from one pose to another, and how much of it has been gone: outside [0, 1] beyond them.
  struct Way {
    const TimedPose* from;
    const TimedPose* to;
    double part;
  };

  [[nodiscard]] Way WayAt(double time) const;

  std::shared_ptr<const head::Bodies> bodies_;
  std::deque<TimedPose> poses_;  // By time.
};

}  // namespace mane::session
