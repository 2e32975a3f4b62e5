#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "base/result.h"
#include "jobs/job_status.h"

namespace mane::jobs {

/// Keeps a callback subscribed; ends the subscription when it goes.
///
/// Once ~Subscription or Reset has returned, the callback is neither running nor called again; they
/// wait for a running one, so they must not be called under a lock that it needs. Within the
/// callback itself they do not wait. May outlive the Watchers.
class Subscription {
 public:
  Subscription() = default;
  Subscription(Subscription&& other) noexcept;
  Subscription& operator=(Subscription&& other) noexcept;
  ~Subscription() { Reset(); }

  void Reset();

 private:
  friend class Watchers;
  class Hub;

  Subscription(std::weak_ptr<Hub> hub, uint64_t number) : hub_(std::move(hub)), number_(number) {}

  std::weak_ptr<Hub> hub_;
  uint64_t number_ = 0;
};

/// Tells subscribers how jobs change.
///
/// All callbacks run on one thread of its own, one at a time and under no lock. Changes that come
/// faster than a subscriber may be called (ten times a second) or faster than callbacks return are
/// merged: each call shows the job as it is then, and the last one always shows how it ended.
/// Nothing is queued, so nothing grows.
class Watchers {
 public:
  /// Called with the job as it is; with NOT_FOUND if it is not there (any more), or with the
  /// store's error. Must not block, for it delays all others, and must not throw: a callback that
  /// does is not called again.
  using Callback = std::function<void(const Result<JobStatus>&)>;
  using Reader = std::function<Result<JobStatus>(const std::string& job_id)>;

  /// `read` is called on the thread of the callbacks until ~Watchers returns.
  explicit Watchers(Reader read);
  /// Waits for a running callback. Must not be called from one.
  ~Watchers();

  /// Calls `callback` soon, then after every change, until it has shown the job ended or an error.
  [[nodiscard]] Subscription Watch(std::string job_id, Callback callback);

  /// Says that a job changed. Cheap; any thread.
  void Changed(const std::string& job_id);

 private:
  std::shared_ptr<Subscription::Hub> hub_;
  std::thread thread_;
};

}  // namespace mane::jobs
