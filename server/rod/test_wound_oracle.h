#pragma once

#include <vector>

#include "rod/test_oracle.h"
#include "rod/wound.h"

/// Brute-force wound strand in long double, which shares no formula with the code under test but
/// the strains of C3: the axis by [SH06] (7a), (7b), derivatives by finite differences, integrals
/// by its own Gauss rule, solves dense.
namespace mane::rod::oracle {

class WoundRod {
 public:
  explicit WoundRod(const Strand& strand);

  [[nodiscard]] int elements() const { return strand_.elements(); }
  /// The beads that carry the inertia, root to tip, (3 x N kBeads); unknowns (4N). `clamp` is
  /// the hair's.
  [[nodiscard]] Matrix3X Beads(const Frame& clamp, const Vector& x) const;
  /// Their derivatives by x, fourth order differences.
  [[nodiscard]] std::vector<Matrix3X> Jacobians(const Frame& clamp, const Vector& x) const;
  /// rho S ds at the beads, (N kBeads).
  [[nodiscard]] Vector Masses() const;
  /// Unknowns of the natural shape (C12), (4N).
  [[nodiscard]] const Vector& Natural() const { return natural_; }
  /// K / l of all elements, (4N x 4N).
  [[nodiscard]] Matrix Stiffness() const;
  /// Friction of a step of `dt` (S10), (4N x 4N).
  [[nodiscard]] Matrix Friction(Real scale, Real dt) const;
  /// -int rho S g.r ds along the axis, 48 points an element, and its gradient.
  [[nodiscard]] Real Gravity(const Frame& clamp, const Vector3& g, const Vector& x) const;
  [[nodiscard]] Vector GravityGradient(const Frame& clamp, const Vector3& g, const Vector& x) const;
  /// (S9) for the weight `w` [N/kg] at the right ends of all elements, as a quadratic form over
  /// rates.
  [[nodiscard]] Matrix Turning(const Frame& clamp, const Vector3& w, const Vector& x) const;
  /// Where the axis starts.
  [[nodiscard]] Frame AxisRoot(const Frame& clamp) const;

 private:
  // Axis frame on along element Q.
  [[nodiscard]] Frame Along(const Frame& left, const Vector& x, int Q, Real u) const;

  const Strand& strand_;
  // Of an element's natural helix.
  struct Helix {
    Real winding, rise, slant;
    Matrix3 F;  // Columns axis, w, axis x w.
  };
  std::vector<Helix> helix_;
  Vector natural_;
};

[[nodiscard]] Vector Stack(const std::vector<Vector4d>& vectors);

/// One step of rod.md (S2) to (S4), (S9), (S10) with coil.md's kinematics, assembled densely;
/// advances `state`.
void DenseStep(const Strand& strand, const ClampMotion& clamp, const Surroundings& air,
               WoundState state);

}  // namespace mane::rod::oracle
