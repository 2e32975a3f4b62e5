#include "session/motion_buffer.h"

#include <algorithm>
#include <limits>

#include "base/check.h"

namespace mane::session {

void MotionBuffer::Add(double time, const math::Pose& pose, double arrival) {
  MANE_CHECK(poses_.empty() || time > poses_.back().time);
  poses_.push_back({time, arrival, pose});
  if (poses_.size() > kMemory) poses_.pop_front();
}

double MotionBuffer::ClientTime(double now) const {
  MANE_CHECK(!poses_.empty());
  double difference = std::numeric_limits<double>::infinity();
  for (const TimedPose& p : poses_) difference = std::min(difference, p.arrival - p.time);
  return now - difference;
}

math::Pose MotionBuffer::At(double time) const {
  MANE_CHECK(!poses_.empty());
  if (poses_.size() == 1 || time <= poses_.front().time) return poses_.front().pose;
  const bool beyond = time >= newest_time();
  if (beyond) time = std::min(time, newest_time() + kMaxExtrapolation);
  // The first pose after `time` and the one before it; beyond the newest, that and one old enough.
  const auto after =
      beyond ? poses_.end() - 1 : std::ranges::upper_bound(poses_, time, {}, &TimedPose::time);
  const auto before =
      beyond ? std::ranges::upper_bound(poses_, newest_time() - kBaseline, {}, &TimedPose::time)
             : after;
  if (before == poses_.begin()) return poses_.back().pose;
  const TimedPose &a = *(before - 1), &b = *after;
  return math::Interpolate(a.pose, b.pose, (time - a.time) / (b.time - a.time));
}

}  // namespace mane::session
