#include "session/mailbox.h"

#include <utility>

namespace mane::session {

void Mailbox::Put(FramePtr frame) {
  if (max_unacked_ > 0 && !waiting_.empty()) {
    waiting_.clear();
    ++skipped_;
  }
  waiting_.push_back(std::move(frame));
}

OutgoingFrame Mailbox::Take() {
  if (waiting_.empty()) return {};
  if (max_unacked_ > 0) {
    if (static_cast<int>(unacked_.size()) >= max_unacked_) return {};
    unacked_.push_back(waiting_.front()->index);
  }
  OutgoingFrame out{std::move(waiting_.front()), std::exchange(skipped_, 0)};
  waiting_.pop_front();
  last_sent_ = out.frame->index;
  return out;
}

Result<void> Mailbox::Acknowledge(uint64_t index) {
  if (index < last_acked_ || index > last_sent_) {
    return InvalidArgument("acked_frame",
                           fmt::format("acked_frame is {}; it must be between the last one "
                                       "acknowledged, {}, and the last one sent, {}",
                                       index, last_acked_, last_sent_));
  }
  last_acked_ = index;
  while (!unacked_.empty() && unacked_.front() <= index) unacked_.pop_front();
  return {};
}

void Mailbox::Reconnect() {
  skipped_ += static_cast<uint32_t>(waiting_.size());
  waiting_.clear();
  unacked_.clear();
  last_acked_ = 0;
}

}  // namespace mane::session
