#pragma once

#include <deque>

namespace mane::session {

/// When a real-time head goes over to a cheaper model of its hair and when it comes back, by how
/// many of its frames come late. A function of what it is told.
///
/// Threads: none of its own; guarded by its owner.
class Shedding {
 public:
  /// So many late frames within kWindow [s] are too many.
  static constexpr int kMostLate = 10;
  static constexpr double kWindow = 1;
  /// The head comes back once no frame has been late for so long [s]. Where it has to go again
  /// within kTrial after that, the next time takes twice as long, at most kLongestCalm.
  static constexpr double kCalm = 5;
  static constexpr double kTrial = 30;
  static constexpr double kLongestCalm = 60;

  /// `count` frames were late; `now` [s] does not decrease from call to call, of Update neither.
  void Late(double now, int count);
  /// Whether the head is to be cheap from `now` on.
  [[nodiscard]] bool Update(double now);

 private:
  struct Lateness {
    double time;
    int count;
  };
  std::deque<Lateness> late_;  // Within kWindow.
  int count_ = 0;              // Their sum.
  bool shed_ = false;
  double last_late_ = 0;
  double came_back_ = 0;
  double calm_ = 0;  // To wait for; 0 before the first time.
};

}  // namespace mane::session
