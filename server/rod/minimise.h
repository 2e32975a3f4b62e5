#pragma once

#include <Eigen/Core>

#include "rod/statics.h"

namespace mane::rod {

/// An energy of many unknowns with its derivatives [J].
class Potential {
 public:
  virtual ~Potential() = default;
  [[nodiscard]] virtual double Energy(const Eigen::VectorXd& x) const = 0;
  [[nodiscard]] virtual Eigen::VectorXd Gradient(const Eigen::VectorXd& x) const = 0;
  [[nodiscard]] virtual Eigen::MatrixXd Hessian(const Eigen::VectorXd& x) const = 0;
};

/// Descends to a local minimum by Newton's method with Levenberg's damping, and leaves saddles
/// (rod.md, Statics).
///
/// @param metric  positive diagonal that damping is measured by, such as the elastic stiffness.
/// @param scale   what the residual is relative to [J].
/// @param x       in: where to start [rad]; out: the minimum.
StaticsReport Minimise(const Potential& potential, const Eigen::VectorXd& metric, double scale,
                       Eigen::VectorXd* x);

}  // namespace mane::rod
