#pragma once

#include <Eigen/Core>

#include <cstdint>
#include <span>
#include <vector>

#include "beam/hull.h"
#include "beam/style.h"

namespace mane::beam {

/// What statics knows of one hair (beam.md, B3 to B5).
struct BendHair {
  Eigen::Vector3d root;       ///< p_0, outside the hull, head frame [m].
  Eigen::Vector3d direction;  ///< e_0, unit.
  double segment_length = 0;  ///< d [m]
  double softness = 0;        ///< rho d^3 / (4 EI) [s^2/m], SoftnessOf.
  uint32_t forces = 0;        ///< Bit f: whether force f acts on it.
};

/// In what hairs hang.
struct BendField {
  Eigen::Vector3d gravity = Eigen::Vector3d::Zero();  ///< Head frame [m/s^2].
  std::vector<Force> forces;                          ///< At most 32; `pores` is not looked at.
};

/// rho d^3 / (4 EI) [s^2/m], but not so much that single precision could not square what it does:
/// softer hair turns by 90 degrees or to the force in any case.
///
/// @param segments  k
[[nodiscard]] double SoftnessOf(double line_density, double segment_length, double rigidity,
                                int segments);

/// n_{i-1}^2 + n_i^2 of segments i = 1 .. k, with n_0 = 0 (B5).
[[nodiscard]] std::vector<double> TurnWeights(int segments);

/// The acceleration at a point from forces that `mask` has the bits of, and gravity [m/s^2].
[[nodiscard]] Eigen::Vector3d AccelerationAt(const BendField& field, uint32_t mask,
                                             const Hull& hull, const Eigen::Vector3d& point);

/// B6 in double precision: the direction in the plane of `before` and e next to e, of a segment
/// from `p` that ends inside along e, along which it does not. The normal at p where none is.
[[nodiscard]] Eigen::Vector3d TurnedOut(const Hull& hull, const Eigen::Vector3d& p, double d,
                                        const Eigen::Vector3d& before, const Eigen::Vector3d& e);

/// One hair bent, segment by segment, in double precision: what the kernels are compared with.
///
/// @param weights  (k); TurnWeights, unless another rule is looked at.
/// @param hull     that nodes keep out of.
/// @return its nodes, head frame [m], (k + 1).
[[nodiscard]] std::vector<Eigen::Vector3d> Bend(const BendHair& hair, const BendField& field,
                                                std::span<const double> weights, const Hull& hull);

}  // namespace mane::beam
