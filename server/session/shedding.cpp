#include "session/shedding.h"

#include <algorithm>

namespace mane::session {

void Shedding::Late(double now, int count) {
  if (count <= 0) return;
  late_.push_back({now, count});
  count_ += count;
  last_late_ = now;
}

bool Shedding::Update(double now) {
  while (!late_.empty() && late_.front().time <= now - kWindow) {
    count_ -= late_.front().count;
    late_.pop_front();
  }
  if (!shed_ && count_ >= kMostLate) {
    const bool again = calm_ > 0 && now - came_back_ < kTrial;
    calm_ = again ? std::min(2 * calm_, kLongestCalm) : kCalm;
    shed_ = true;
  } else if (shed_ && now - last_late_ >= calm_) {
    shed_ = false;
    came_back_ = now;
  }
  return shed_;
}

}  // namespace mane::session
