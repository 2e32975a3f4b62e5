#pragma once

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

#include "rod/fit_cost.h"
#include "rod/smooth_curve.h"

namespace mane::rod {

/// Minimises FitCost from F3's guesses. One object is one fit.
class Fitter {
 public:
  using Shape = FitCost::Shape;

  /// @param curve     must outlive this, as must `points`.
  /// @param points    what `curve` was made of; the first one at the origin.
  /// @param fraction  where elements begin and end, in parts of the length, (N + 1), 0 to 1.
  /// @param root      the root frame, or nothing where its tangent is to be fitted.
  Fitter(const SmoothCurve& curve, std::span<const Eigen::Vector3d> points,
         std::vector<double> fraction, const std::optional<Eigen::Matrix3d>& root);

  /// Minimises from guesses of less and less twist until one ends near the points; keeps the best.
  /// Always ends with a finite shape, no worse than the first guess.
  void Run();

  [[nodiscard]] const Shape& shape() const { return shape_; }
  /// Distances of the points, without the first, from their matches.
  [[nodiscard]] double largest_distance() const { return largest_distance_; }
  [[nodiscard]] double rms_distance() const { return rms_distance_; }
  [[nodiscard]] int iterations() const { return iterations_; }

 private:
  void Start(double twist_weight);
  void SetTargets();
  void RunFromHere();
  [[nodiscard]] Shape Moved(const Eigen::VectorXd& step) const;
  [[nodiscard]] Eigen::VectorXd Step(const std::vector<FitCost::Placed>& placed,
                                     double lambda) const;
  void Minimise();
  void Measure();

  const SmoothCurve& curve_;
  const std::span<const Eigen::Vector3d> points_;
  const Eigen::Matrix3d root_;
  const bool root_free_;
  const double noise_;
  FitCost cost_;
  double least_length_, most_length_;
  Shape shape_;
  std::vector<FitCost::Target> targets_;  // The last one is the tip.
  double largest_distance_ = 0, rms_distance_ = 0;
  int iterations_ = 0;
};

}  // namespace mane::rod
