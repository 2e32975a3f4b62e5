#include "contact/search_budget.h"

#include <fmt/format.h>

namespace mane::contact {
namespace {

// Work of a thread after which its budget learns of it.
constexpr uint64_t kStep = 1'000'000;

}  // namespace

thread_local SearchBudget::Share* SearchBudget::share_ = nullptr;

SearchBudget::Share::Share(SearchBudget* budget) : budget_(budget), outer_(share_) {
  share_ = this;
}

SearchBudget::Share::~Share() {
  share_ = outer_;
  if (budget_ != nullptr) budget_->Spend(counted_);
}

void SearchBudget::Count(uint64_t work) {
  if (share_ == nullptr || share_->budget_ == nullptr) return;
  share_->counted_ += work;
  if (share_->counted_ < kStep) return;
  share_->budget_->Spend(share_->counted_);
  share_->counted_ = 0;
}

void SearchBudget::Spend(uint64_t work) {
  State going = State::kGoing;
  if (spent_.fetch_add(work) + work > most_) {
    state_.compare_exchange_strong(going, State::kSpent);
  } else if (base::IsCancelled(cancelled_)) {
    state_.compare_exchange_strong(going, State::kCancelled);
  }
}

Result<void> SearchBudget::Check() const {
  switch (state_) {
    case State::kGoing:
      return {};
    case State::kCancelled:
      return base::CancelledError();
    case State::kSpent:
      break;
  }
  return TooMuch();
}

Error SearchBudget::TooMuch() const {
  return {ErrorCode::kResourceExhausted,
          fmt::format("triangles need a distance field that takes more than {:.0f} s of one "
                      "core to make, the limit: use a coarser mesh, or a cleaner one, whose "
                      "surface is smooth and does not pass through itself",
                      static_cast<double>(most_) * 1e-9),
          "triangles"};
}

}  // namespace mane::contact
