#pragma once

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <list>
#include <mutex>
#include <optional>

#include "base/cancelled.h"

namespace mane::exec {

/// One value that several may want at once: who asks first makes it, on the own thread, and the
/// others wait for that.
///
/// Threads: Get from any. `mutex_` guards all, and is not held while the value is made. Callers'
/// `cancelled` are asked while it is held: what they lock comes after it, always.
template <typename Value>
class Joint {
 public:
  /// What makes it; is to return soon once its argument says so, with kCancelled.
  using Make = std::function<Result<Value>(const base::Cancelled&)>;

  /// The value, or the error with which `make` failed, for all who want it. kCancelled soon after
  /// `cancelled` says so, except to the one who makes it: that stops when nobody wants it any more,
  /// and is begun anew by who comes then.
  Result<Value> Get(const base::Cancelled& cancelled, const Make& make) {
    std::unique_lock lock(mutex_);
    const auto own = wanted_.insert(wanted_.end(), &cancelled);
    Result<Value> got = WaitOrMake(lock, cancelled, make);
    wanted_.erase(own);
    return got;
  }

 private:
  // How often those who wait look whether their own caller still does.
  static constexpr std::chrono::milliseconds kPause{50};

  Result<Value> WaitOrMake(std::unique_lock<std::mutex>& lock, const base::Cancelled& cancelled,
                           const Make& make) {
    for (; !outcome_ && making_; changed_.wait_for(lock, kPause)) {
      if (base::IsCancelled(cancelled)) return base::CancelledError();
    }
    if (outcome_) return *outcome_;
    making_ = true;
    lock.unlock();
    Result<Value> made = Made(make);
    lock.lock();
    making_ = false;
    if (made || made.error().code != ErrorCode::kCancelled) outcome_ = made;
    changed_.notify_all();
    return made;
  }

  // What fails by an exception fails for all.
  Result<Value> Made(const Make& make) try {
    return make([this] { return Unwanted(); });
  } catch (const std::exception& fault) {
    return Error{ErrorCode::kInternal, fault.what(), ""};
  }

  [[nodiscard]] bool Unwanted() {
    std::lock_guard lock(mutex_);
    return std::ranges::all_of(wanted_, [](const auto* each) { return base::IsCancelled(*each); });
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::list<const base::Cancelled*> wanted_;  // Of all who are in Get.
  bool making_ = false;
  std::optional<Result<Value>> outcome_;
};

}  // namespace mane::exec
