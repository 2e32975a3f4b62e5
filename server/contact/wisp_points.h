#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>

#include "contact/distance.h"

namespace mane::contact {

/// Whether no coordinate is larger than `limit`, or no number.
[[nodiscard]] inline bool Within(const Eigen::Vector3f& v, float limit) {
  return (v.array().abs() <= limit).all();
}

/// Velocities of many points as three lists of equal length [m/s].
struct VelocitySpans {
  std::span<const float> x, y, z;

  [[nodiscard]] Eigen::Vector3f operator[](size_t p) const { return {x[p], y[p], z[p]}; }
};

/// Impulses on many points as three lists of equal length [kg m/s].
struct ImpulseSpans {
  std::span<float> x, y, z;
};

/// The sample points of all guides of a head where a time step is linearised: guide after guide,
/// root to tip. Lists over points have one length.
struct WispPoints {
  PointSpans position;             ///< Extrapolated to kTheta of the step [m].
  VelocitySpans velocity;          ///< With which they were, that of the last step [m/s].
  std::span<const float> mass;     ///< That a point stands for [kg].
  PointSpans rest;                 ///< The rest shape, in any frame [m]; empty where there is none.
  std::span<const int32_t> first;  ///< First point of every guide, and their number (guides + 1).
  std::span<const float> radius;   ///< Of the wisp around a guide [m]; 0 for none (guides).
  std::span<const float> curliness;  ///< 0 straight to 1 tightly curled (guides).

  [[nodiscard]] int guides() const { return static_cast<int>(first.size()) - 1; }
  [[nodiscard]] int size() const { return static_cast<int>(mass.size()); }
  [[nodiscard]] Eigen::Vector3f Position(size_t p) const {
    return {position.x[p], position.y[p], position.z[p]};
  }
  [[nodiscard]] Eigen::Vector3f Rest(size_t p) const { return {rest.x[p], rest.y[p], rest.z[p]}; }
};

}  // namespace mane::contact
