#include "session/motion_buffer.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "base/check.h"

namespace mane::session {

void MotionBuffer::Add(double time, const math::Pose& pose, double arrival, BodyPoses bodies) {
  MANE_CHECK(poses_.empty() || time > poses_.back().time);
  poses_.push_back({time, arrival, pose, std::move(bodies)});
  if (poses_.size() > kMemory) poses_.pop_front();
}

double MotionBuffer::ClientTime(double now) const {
  MANE_CHECK(!poses_.empty());
  double difference = std::numeric_limits<double>::infinity();
  for (const TimedPose& p : poses_) difference = std::min(difference, p.arrival - p.time);
  return now - difference;
}

math::Pose MotionBuffer::At(double time) const {
  const Way way = WayAt(time);
  if (way.from == way.to) return way.to->pose;
  return math::Interpolate(way.from->pose, way.to->pose, way.part);
}

std::vector<math::Pose> MotionBuffer::BodiesAt(double time) const {
  const Way way = WayAt(time);
  const std::vector<math::Pose> from = PlaceBodies(bodies_.get(), way.from->pose, way.from->bodies);
  const std::vector<math::Pose> to = PlaceBodies(bodies_.get(), way.to->pose, way.to->bodies);
  std::vector<math::Pose> poses = PlaceBodies(bodies_.get(), At(time), {});
  for (size_t i = 0; i < way.to->bodies.size(); ++i) {
    if (way.to->bodies[i]) poses[i] = math::Interpolate(from[i], to[i], way.part);
  }
  return poses;
}

MotionBuffer::Way MotionBuffer::WayAt(double time) const {
  MANE_CHECK(!poses_.empty());
  const TimedPose &first = poses_.front(), &newest = poses_.back();
  if (poses_.size() == 1 || time <= first.time) return {&first, &first, 1};
  const bool beyond = time >= newest_time();
  if (beyond) time = std::min(time, newest_time() + kMaxExtrapolation);
  // The first pose after `time` and the one before it; beyond the newest, that and one old enough.
  const auto after =
      beyond ? poses_.end() - 1 : std::ranges::upper_bound(poses_, time, {}, &TimedPose::time);
  const auto before =
      beyond ? std::ranges::upper_bound(poses_, newest_time() - kBaseline, {}, &TimedPose::time)
             : after;
  if (before == poses_.begin()) return {&newest, &newest, 1};
  const TimedPose &a = *(before - 1), &b = *after;
  return {&a, &b, (time - a.time) / (b.time - a.time)};
}

}  // namespace mane::session
