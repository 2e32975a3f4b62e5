#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <vector>

namespace mane {

/// Median seconds of one call of `work`, which is repeated for about `seconds`.
inline double Median(double seconds, const std::function<void(int)>& work) {
  using Clock = std::chrono::steady_clock;
  const auto now = [] { return std::chrono::duration<double>(Clock::now().time_since_epoch()); };
  std::vector<double> times;
  const auto end = now() + std::chrono::duration<double>(seconds);
  for (int i = 0; now() < end || times.size() < 5; ++i) {
    const auto start = now();
    work(i);
    times.push_back((now() - start).count());
  }
  std::ranges::nth_element(times, times.begin() + times.size() / 2);
  return times[times.size() / 2];
}

}  // namespace mane
