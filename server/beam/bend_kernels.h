#pragma once

namespace mane::beam {

/// How a block of hairs lies in memory for statics: rows of simd::kLanes numbers.
namespace bend_layout {
inline constexpr int kRoot = 0;          ///< From the hull's center [m], 3 rows.
inline constexpr int kDirection = 3;     ///< Unit, 3 rows.
inline constexpr int kLength = 6;        ///< d [m]
inline constexpr int kSoftness = 7;      ///< rho d^3 / (4 EI) [s^2/m] (B5).
inline constexpr int kFirstForce = 8;    ///< 1 where the force acts on the hair, else 0; each.
inline constexpr int kPlaneNumbers = 4;  ///< Normal, offset.
}  // namespace bend_layout

/// A force besides gravity (Force, style.h), positions from the hull's center.
template <typename T>
struct BendForce {
  enum class Kind { kUniform, kToward, kAround };
  Kind kind;
  T vector[3];      ///< [m/s^2]
  T point[3];       ///< [m]
  T strength;       ///< [m/s^2]
  T softening;      ///< [m]
  const T* planes;  ///< Where it acts, (planes x kPlaneNumbers).
  int plane_count;
};

/// What hairs hang in; the same for all lanes.
template <typename T>
struct BendScene {
  T inverse_radii[3];  ///< Of the hull that nodes keep out of [1/m].
  T gravity[3];        ///< [m/s^2]
  const BendForce<T>* forces;
  int force_count;
};

/// Statics of a block (beam.md, B3 to B6).
template <typename T>
struct BendKernels {
  /// @param weights  n_{i-1}^2 + n_i^2 of each segment, (segments) (B5).
  /// @param hairs    (kFirstForce + force_count) rows.
  /// @param nodes    from the hull's center [m], (segments + 1) x 3 rows.
  void (*bend)(int segments, const T* weights, const BendScene<T>& scene, const T* hairs, T* nodes);
};

}  // namespace mane::beam
