#pragma once

#include <Eigen/Core>

#include <array>
#include <cstdint>
#include <span>

#include "rod/batch.h"

namespace mane::head {

/// How the air changes in time and space around its mean velocity. Zeros for none.
struct WindVariation {
  double gust_strength = 0;      ///< Gusts: rms of the relative change of the mean speed.
  double gust_period = 2;        ///< Their middle period [s].
  double turbulence_speed = 0;   ///< Eddies: rms speed [m/s].
  double turbulence_size = 0.3;  ///< Their middle size [m].
  uint64_t seed = 0;
};

/// Air velocity as a function of place and time: a mean that gusts, and eddies that the mean
/// carries along. Both are sums of cosines drawn by the seed within an octave to either side of the
/// middle period or size, so that nothing is faster or smaller than a time step and hair can
/// follow; eddies have no divergence. The same bits for the same arguments.
class WindField {
 public:
  WindField(const Eigen::Vector3d& mean, const WindVariation& variation);

  /// Velocity without eddies at time `t` [s].
  [[nodiscard]] Eigen::Vector3d Mean(double t) const;
  [[nodiscard]] bool turbulent() const { return speed_ > 0; }

  /// Rows of one number per lane: x, y, z.
  using Lanes = std::span<rod::Row<float>, 3>;
  /// Velocity with eddies at time `t` at the places `origin` + `offset` [m], lane by lane: the
  /// eddies of places metres apart are as precise as float32, wherever the origin is.
  void Evaluate(double t, const Eigen::Vector3d& origin, std::span<const rod::Row<float>, 3> offset,
                Lanes velocity) const;

 private:
  static constexpr int kGusts = 6, kEddies = 16;
  struct Gust {
    double frequency;  // [rad/s]
    double phase;
  };
  struct Eddy {
    Eigen::Vector3d k;         // Wave vector [rad/m].
    Eigen::Vector3d velocity;  // Amplitude, normal to k [m/s].
    double frequency;          // Of its own, seen from the moving air [rad/s].
    double phase;
  };

  Eigen::Vector3d mean_;
  double gust_strength_, speed_;
  std::array<Gust, kGusts> gusts_;
  std::array<Eddy, kEddies> eddies_;
};

}  // namespace mane::head
