#pragma once

#include <Eigen/Core>

namespace mane::beam {

/// How hair shines ([AUK92] 4.1; beam.md, B16): one number for each, colours are the caller's, who
/// multiplies each part by what colour it has.
struct Shine {
  double ambient_intensity = 1;  ///< I_a
  double ambient = 0.3;          ///< k_a
  double light_intensity = 1;    ///< I_s
  double specular = 0.7;         ///< k_s
  double exponent = 40;          ///< n, >= 0: the larger, the sharper.
};

/// Intensities at a point of a hair.
struct Highlight {
  double ambient;   ///< I_a k_a f
  double specular;  ///< I_s Phi_s

  [[nodiscard]] double total() const { return ambient + specular; }  ///< I (B16).
};

/// Phi_s of B17: k_s (1 - (T . H)^2)^(n / 2), the brightest of what Blinn's model gives for the
/// normals of a thin cylinder.
///
/// @param tangent   T, unit, either way along the hair.
/// @param to_light  L, unit, from the point.
/// @param to_eye    V, unit.
/// @return 0 where L = -V: there is no H halfway between, and the light is behind the hair.
[[nodiscard]] double Specular(const Eigen::Vector3d& tangent, const Eigen::Vector3d& to_light,
                              const Eigen::Vector3d& to_eye, const Shine& shine);

/// B16 of one light. `factor` is the hair's own one on k_a, f (B18).
[[nodiscard]] Highlight HighlightOf(const Eigen::Vector3d& tangent, const Eigen::Vector3d& to_light,
                                    const Eigen::Vector3d& to_eye, const Shine& shine,
                                    double factor);

}  // namespace mane::beam
