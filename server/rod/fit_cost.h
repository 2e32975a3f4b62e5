#pragma once

#include <Eigen/Core>

#include <utility>
#include <vector>

namespace mane::rod {

/// What a fit minimises (rod.md, F4 and F5) and its normal matrix (F6), in units in which the curve
/// is of size about one and starts at the origin.
class FitCost {
 public:
  /// The unknowns.
  struct Shape {
    Eigen::Matrix3d R;                   ///< Root frame.
    double L;                            ///< Length.
    std::vector<Eigen::Vector3d> theta;  ///< Element angles [rad], (N).
  };
  /// A point to be met, and where along the strand, in parts of its length.
  struct Target {
    Eigen::Vector3d x;
    double u;
    double weight;
  };
  /// Its match on the centreline: position and tangent at `s` in [0, 1] of the element.
  struct Placed {
    int element;
    double s;
    Eigen::Vector3d r, t;
  };

  /// @param fraction  where elements begin and end, in parts of the length, (N + 1), 0 to 1.
  explicit FitCost(std::vector<double> fraction) : fraction_(std::move(fraction)) {}

  bool sliding = false;  ///< Whether matches follow the shape.
  double variance = 0;   ///< Of the residuals, that the penalty is measured by.

  [[nodiscard]] int N() const { return static_cast<int>(fraction_.size()) - 1; }
  [[nodiscard]] const std::vector<double>& fraction() const { return fraction_; }
  /// Length of element Q in parts of the whole.
  [[nodiscard]] double Part(int Q) const { return fraction_[Q + 1] - fraction_[Q]; }

  /// Matches of the targets, of which the last is the tip; where they slide, moved to the nearest
  /// point nearby, in order.
  std::vector<Placed> Place(const Shape& shape, std::vector<Target>* targets) const;
  /// The sum of squares with its penalty.
  [[nodiscard]] double Value(const Shape& shape, const std::vector<Target>& targets,
                             const std::vector<Placed>& placed) const;
  /// Gauss and Newton's matrix, of which only the lower half is set, and half the slope over (root
  /// 2, length 1, angles 3N).
  void Normal(const Shape& shape, const std::vector<Target>& targets,
              const std::vector<Placed>& placed, Eigen::MatrixXd* H, Eigen::VectorXd* g) const;

 private:
  void AddPenalty(const Shape& shape, Eigen::MatrixXd* H, Eigen::VectorXd* g) const;

  std::vector<double> fraction_;
};

}  // namespace mane::rod
