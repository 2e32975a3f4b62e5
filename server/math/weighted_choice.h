#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "math/random.h"

namespace mane::math {

/// Chooses among items in proportion to their weights, each >= 0 and at least one above.
class WeightedChoice {
 public:
  /// The next item's.
  void Add(double weight) { sums_.push_back(total() + weight); }
  [[nodiscard]] double total() const { return sums_.empty() ? 0 : sums_.back(); }
  /// Index of an item; draws one number. O(log items).
  [[nodiscard]] int Choose(RandomStream& random) const {
    const auto at = std::ranges::upper_bound(sums_, random.Uniform() * total());
    return static_cast<int>(std::min<ptrdiff_t>(at - sums_.begin(), std::ssize(sums_) - 1));
  }

 private:
  std::vector<double> sums_;
};

}  // namespace mane::math
