#pragma once

#include <deque>

#include "base/result.h"
#include "session/frame.h"

namespace mane::session {

/// Frames between the simulation and one client's stream. Both kinds are bounded: a finished write
/// says nothing about the client (it may lie in a socket buffer for seconds), so the real-time kind
/// goes by the client's own acknowledgements.
///
/// Threads: none of its own; guarded by its owner.
class Mailbox {
 public:
  /// One slot, newest wins; at most `max_unacked` frames are out unacknowledged.
  static Mailbox Newest(int max_unacked) { return Mailbox(max_unacked); }
  /// All frames, in order; the producer must look at size().
  static Mailbox Ordered() { return Mailbox(0); }

  void Put(FramePtr frame);
  /// The next frame to send, if there is one and the client may be sent one.
  [[nodiscard]] OutgoingFrame Take();
  /// The client has consumed everything up to frame `index`. kInvalidArgument for an index that was
  /// never sent or is below an earlier one.
  Result<void> Acknowledge(uint64_t index);
  /// A new stream takes over: what was out or waiting is lost; the new stream begins with what
  /// comes.
  void Reconnect();

  /// Frames waiting here.
  [[nodiscard]] int size() const { return static_cast<int>(waiting_.size()); }

 private:
  explicit Mailbox(int max_unacked) : max_unacked_(max_unacked) {}

  int max_unacked_;  // 0: ordered, not acknowledged.
  std::deque<FramePtr> waiting_;
  std::deque<uint64_t> unacked_;  // Indices sent, oldest first.
  uint64_t last_sent_ = 0;
  uint64_t last_acked_ = 0;
  uint32_t skipped_ = 0;
};

}  // namespace mane::session
