#pragma once

#include <cstdint>

namespace mane::math {

/// Counter-based random stream: the k-th number of stream `stream` under `seed` depends on nothing
/// else, so that any worker can draw it. Mixes with the finaliser of SplitMix64, twice.
class RandomStream {
 public:
  RandomStream(uint64_t seed, uint64_t stream) : key_(Mix(seed ^ Mix(stream + kGolden))) {}

  /// The next 64 random bits.
  uint64_t Bits() { return Mix(key_ + kGolden * ++counter_); }
  /// Uniform in [0, 1), 53 bits.
  double Uniform() { return static_cast<double>(Bits() >> 11) * 0x1p-53; }
  /// Uniform in [low, high).
  double Uniform(double low, double high) { return low + (high - low) * Uniform(); }
  /// Standard normal (Box-Muller; draws two numbers).
  double Normal();

 private:
  static constexpr uint64_t kGolden = 0x9e3779b97f4a7c15;
  static uint64_t Mix(uint64_t z) {
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9;
    z = (z ^ (z >> 27)) * 0x94d049bb133111eb;
    return z ^ (z >> 31);
  }

  uint64_t key_;
  uint64_t counter_ = 0;
};

}  // namespace mane::math
