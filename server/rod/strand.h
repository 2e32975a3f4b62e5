#pragma once

#include <Eigen/Core>

#include <vector>

namespace mane::rod {

/// Elliptic cross-section: semi-axes along n1 and n2 [m].
struct Section {
  double radius_1 = 0;
  double radius_2 = 0;
};

/// What the strand is made of.
struct Material {
  double young_modulus = 0;  ///< E [Pa]
  double poisson_ratio = 0;  ///< sigma, in (-1, 0.5]
  double density = 0;        ///< rho [kg/m^3]
};

/// Constant description of one Super-Helix of N elements ([SH06] 3.1, 3.2): what its motion depends
/// on besides its state, its clamp and the air.
struct Strand {
  std::vector<double> length;  ///< Element lengths l_Q, root to tip [m], (N).
  std::vector<Eigen::Vector3d>
      natural;  ///< Natural (twist, curvature 1, curvature 2) [rad/m], (N).
  /// (EI)_i of [SH06] (5c) [N m^2]: torsion mu J, bending about n1, bending about n2.
  Eigen::Vector3d stiffness = Eigen::Vector3d::Zero();
  double linear_density = 0;     ///< rho S [kg/m]
  double internal_friction = 0;  ///< gamma of [SH06] (5d) [kg m^3/s]
  double air_drag = 0;           ///< nu of [SH06] (5a) [kg/(m s)]

  [[nodiscard]] int elements() const { return static_cast<int>(length.size()); }
  /// Strand length L [m]; O(N).
  [[nodiscard]] double TotalLength() const;
};

/// (EI)_i of an elliptic section: E pi/4 a b^3 about n1, E pi/4 a^3 b about n2, where a and b are
/// the semi-axes along n1 and n2, and the torsion mu J = E / (2 (1 + sigma)) pi a^3 b^3 / (a^2 +
/// b^2), Saint-Venant's constant of an ellipse.
[[nodiscard]] Eigen::Vector3d Stiffness(const Section& section, const Material& material);

/// rho S = rho pi a b [kg/m].
[[nodiscard]] double LinearDensity(const Section& section, const Material& material);

}  // namespace mane::rod
