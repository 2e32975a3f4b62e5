#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

namespace mane::styling {

/// Kolmogorov's and Smirnov's statistic sqrt(n) sup |F_n - F|, for tests. It exceeds 2.2 by chance
/// once in 8,000 samples of F.
template <typename Cdf>
double KolmogorovSmirnov(std::vector<double> sample, const Cdf& cdf) {
  std::sort(sample.begin(), sample.end());
  const auto n = static_cast<double>(sample.size());
  double largest = 0;
  for (size_t i = 0; i < sample.size(); ++i) {
    const double F = cdf(sample[i]);
    largest =
        std::max({largest, static_cast<double>(i + 1) / n - F, F - static_cast<double>(i) / n});
  }
  return std::sqrt(n) * largest;
}

inline constexpr double kKolmogorovSmirnovLimit = 2.2;

}  // namespace mane::styling
