#pragma once

#include <atomic>
#include <cstdint>

#include "base/cancelled.h"

namespace mane::contact {

/// What the searches that make a field may take together: counts their work, and asks now and then
/// whether the field is still wanted. Once it is over, searches return at once with anything, for
/// who makes the field to throw away.
///
/// Threads: any. A loop over pieces holds a Share in each; searches outside of one are not counted.
/// What all count together does not depend on who counts it.
class SearchBudget {
 public:
  /// @param most  nanoseconds of one core, about.
  SearchBudget(uint64_t most, base::Cancelled cancelled)
      : most_(most), cancelled_(std::move(cancelled)) {}

  [[nodiscard]] bool over() const {
    return state_.load(std::memory_order_relaxed) != State::kGoing;
  }
  [[nodiscard]] uint64_t spent() const { return spent_; }
  [[nodiscard]] uint64_t most() const { return most_; }
  [[nodiscard]] const base::Cancelled& cancelled() const { return cancelled_; }

  /// kCancelled when the field is not wanted; RESOURCE_EXHAUSTED naming `triangles` where searches
  /// would have taken more than there is.
  [[nodiscard]] Result<void> Check() const;
  /// That RESOURCE_EXHAUSTED.
  [[nodiscard]] Error TooMuch() const;

  /// Of a thread that makes a piece; the budget, if any, learns of the work in steps, and all of it
  /// at the end.
  class Share {
   public:
    explicit Share(SearchBudget* budget);
    ~Share();
    Share(const Share&) = delete;
    Share& operator=(const Share&) = delete;

   private:
    friend class SearchBudget;
    SearchBudget* const budget_;
    Share* const outer_;
    uint64_t counted_ = 0;
  };

  /// Counts work of this thread's Share.
  static void Count(uint64_t work);
  /// Whether this thread's budget is over.
  [[nodiscard]] static bool Over() {
    return share_ != nullptr && share_->budget_ != nullptr && share_->budget_->over();
  }

 private:
  enum class State { kGoing, kSpent, kCancelled };

  void Spend(uint64_t work);

  static thread_local Share* share_;  // The innermost of this thread.
  const uint64_t most_;
  const base::Cancelled cancelled_;
  std::atomic<uint64_t> spent_ = 0;
  std::atomic<State> state_ = State::kGoing;
};

}  // namespace mane::contact
