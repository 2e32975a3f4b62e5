#include "styling/synthesis.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/check.h"
#include "groom/range.h"
#include "math/random.h"

namespace mane::styling {
namespace {

constexpr int kLanes = 16;
constexpr uint64_t kSalt = 0x53594e5448455349;  // Of this file's streams.
constexpr float kNegligible = 40;               // exp(-40) of the best match's weight.

}  // namespace

Result<PrototypeModel> PrototypeModel::Make(const Pattern& pattern, const Synthesis& synthesis,
                                            const std::string& field) {
  const auto m = static_cast<int>(pattern.details.size());
  MANE_CHECK(m >= 1 && m <= kMostDetails && pattern.structure >= 0);
  PrototypeModel model;
  model.details_ = pattern.details;
  double sum = 0;
  for (const Eigen::Vector3f& delta : pattern.details) sum += delta.squaredNorm();
  model.rms_ = std::sqrt(sum / m);
  const bool smooth = model.rms_ == 0;
  MANE_CHECK(smooth || pattern.structure < m);

  const groom::Range windows{
      0, static_cast<double>(smooth ? kMostWindow : std::clamp(m / 2, 1, kMostWindow))};
  if (!windows.Contains(synthesis.window)) {
    return groom::OutOfRange(field + ".window", synthesis.window, windows);
  }
  const groom::Range temperatures{0, 1000};
  if (!temperatures.Contains(synthesis.temperature)) {
    return groom::OutOfRange(field + ".temperature", synthesis.temperature, temperatures);
  }

  // Whole windows must be left at every place of a period, or the pattern could not go on (W11).
  const int P = pattern.structure;
  model.window_ =
      synthesis.window > 0 ? synthesis.window : std::clamp(std::min(P, m - P), 1, kMostWindow);
  model.fade_ = std::max(1, P);
  model.temperature_ = synthesis.temperature * model.rms_;
  if (smooth) return model;
  model.distance2_.resize(static_cast<size_t>(m) * m + kLanes);  // Next reads a little beyond.
  for (int j = 0; j < m; ++j) {
    for (int k = 0; k < m; ++k) {
      model.distance2_[static_cast<size_t>(j) * m + k] =
          (model.details_[j] - model.details_[k]).squaredNorm();
    }
  }
  return model;
}

int PrototypeModel::Next(std::span<const int> past, double u) const {
  const int m = size(), n = static_cast<int>(past.size());
  // (W9) squared: candidate k = n, ..., m - 1 follows the window that ends in k - 1. Sixteen sums
  // stay in registers; those beyond m - 1 add up what is behind the row and count for nothing.
  std::array<float, kMostDetails + kLanes> energy;
  for (int begin = n; begin < m; begin += kLanes) {
    std::array<float, kLanes> sum{};
    for (int t = 1; t <= n; ++t) {
      const float* row = &distance2_[static_cast<size_t>(past[n - t]) * m + begin - t];
      for (int lane = 0; lane < kLanes; ++lane) sum[lane] += row[lane];
    }
    std::copy(sum.begin(), sum.end(), energy.begin() + begin);
  }
  const auto best = std::min_element(energy.begin() + n, energy.begin() + m);
  if (temperature_ == 0) return static_cast<int>(best - energy.begin());

  // (W10) relative to the best match, so that no exponential overflows and one is 1.
  const float scale = static_cast<float>(window_) / static_cast<float>(n);
  const float least = std::sqrt(scale * *best);
  const auto inverse = static_cast<float>(std::min(1 / temperature_, 1e30));  // Finite.
  float Z = 0;
  for (int k = n; k < m; ++k) {
    const float cost = (std::sqrt(scale * energy[k]) - least) * inverse;
    energy[k] = Z += cost < kNegligible ? std::exp(-cost) : 0;
  }
  const auto chosen = std::upper_bound(energy.begin() + n, energy.begin() + m,
                                       static_cast<float>(u * static_cast<double>(Z)));
  return std::min(static_cast<int>(chosen - energy.begin()), m - 1);
}

void Synthesize(const PrototypeModel& model, uint64_t seed, uint64_t stream,
                std::span<Eigen::Vector3f> out) {
  if (out.empty()) return;
  std::fill(out.begin(), out.end(), Eigen::Vector3f::Zero());
  if (model.rms_ == 0) return;
  math::RandomStream random(seed ^ kSalt, stream);
  std::array<int, 2 * kMostWindow> past;  // What was chosen, the newest last.
  int n = 0;
  int chosen = 0;  // The first detail is the prototype's first (W11).
  for (size_t i = 0; i < out.size(); ++i) {
    if (i > 0) {
      const int h = std::min(n, model.window_);
      chosen = model.Next({past.data() + n - h, static_cast<size_t>(h)}, random.Uniform());
    }
    if (n == static_cast<int>(past.size())) {
      std::copy(past.end() - kMostWindow, past.end(), past.begin());
      n = kMostWindow;
    }
    past[n++] = chosen;
    const float t = std::min(1.0F, static_cast<float>(i) / static_cast<float>(model.fade_));
    out[i] = t * t * (3 - 2 * t) * model.details_[chosen];  // (W12)
  }
}

}  // namespace mane::styling
