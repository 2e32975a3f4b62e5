#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "styling/prototype.h"
#include "styling/style.h"

namespace mane::styling {

/// Largest window h: with kMostDetails it bounds what a control point costs.
inline constexpr int kMostWindow = 64;

/// A prototype's pattern made ready to draw strands from, [CK05] (2) to (4), wisps.md (W9) to
/// (W12). Immutable; many threads may draw at once.
class PrototypeModel {
 public:
  /// @param field  path of `synthesis`, for errors.
  /// @return INVALID_ARGUMENT naming `<field>.window` (more than half the pattern, or than
  ///   kMostWindow) or `<field>.temperature` (not in [0, 1000]).
  [[nodiscard]] static Result<PrototypeModel> Make(const Pattern& pattern,
                                                   const Synthesis& synthesis,
                                                   const std::string& field);

  [[nodiscard]] int size() const { return static_cast<int>(details_.size()); }
  [[nodiscard]] int window() const { return window_; }
  /// Root of the mean square of the details' lengths [m].
  [[nodiscard]] double rms() const { return rms_; }

 private:
  friend void Synthesize(const PrototypeModel&, uint64_t, uint64_t, std::span<Eigen::Vector3f>);

  PrototypeModel() = default;

  // Index of the next detail, after those of `past` (the newest last), for u uniform in [0, 1).
  [[nodiscard]] int Next(std::span<const int> past, double u) const;

  std::vector<Eigen::Vector3f> details_;
  std::vector<float> distance2_;  // |delta*_j - delta*_k|^2, (size x size).
  int window_ = 1;                // h
  int fade_ = 1;                  // Control points over which details rise from the root.
  double rms_ = 0;
  double temperature_ = 0;  // [m]
};

/// Details of a new strand, root first: fills `out` with delta_0 = 0, delta_1, ...
///
/// At temperature 0 every strand repeats the prototype from its first detail on, and beyond its end
/// goes on as its pattern does; else each number is drawn from stream `stream` of `seed`. Details
/// rise smoothly from 0 over the first structure, so that the strand starts in its root, (W12).
///
/// Cost: m h additions and, above temperature 0, up to m exponentials a control point, of the
/// prototype's m; no allocation.
void Synthesize(const PrototypeModel& model, uint64_t seed, uint64_t stream,
                std::span<Eigen::Vector3f> out);

}  // namespace mane::styling
