#pragma once

#include <Eigen/Core>

#include <optional>
#include <span>
#include <vector>

#include "rod/smooth_curve.h"

namespace mane::rod {

/// The least squares problem of a fit (rod.md, F4 to F6), in units in which the curve is of size
/// about one and starts at the origin. One object is one fit; it starts from F3's guess.
class Fitter {
 public:
  /// The unknowns.
  struct Shape {
    Eigen::Matrix3d R;                   ///< Root frame.
    double L;                            ///< Length.
    std::vector<Eigen::Vector3d> theta;  ///< Element angles [rad], (N).
  };

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
  // A point to be met, and where along the strand, in parts of its length.
  struct Target {
    Eigen::Vector3d x;
    double u;
    double weight;
  };
  // Its match on the centreline: position and tangent at `s` in [0, 1] of the element.
  struct Placed {
    int element;
    double s;
    Eigen::Vector3d r, t;
  };

  [[nodiscard]] int N() const { return static_cast<int>(fraction_.size()) - 1; }
  [[nodiscard]] double Part(int Q) const { return fraction_[Q + 1] - fraction_[Q]; }
  void Start(double twist_weight);
  void SetTargets();
  void RunFromHere();
  std::vector<Placed> Place(const Shape& shape, std::vector<Target>* targets) const;
  [[nodiscard]] double Cost(const Shape& shape, const std::vector<Target>& targets,
                            const std::vector<Placed>& placed) const;
  void Normal(const std::vector<Placed>& placed, Eigen::MatrixXd* H, Eigen::VectorXd* g) const;
  void AddPenalty(Eigen::MatrixXd* H, Eigen::VectorXd* g) const;
  [[nodiscard]] Shape Moved(const Eigen::VectorXd& step) const;
  [[nodiscard]] Eigen::VectorXd Step(const std::vector<Placed>& placed, double lambda) const;
  void Minimise();
  void Measure();

  const SmoothCurve& curve_;
  const std::span<const Eigen::Vector3d> points_;
  const Eigen::Matrix3d root_;
  const bool root_free_;
  const double noise_;
  const std::vector<double> fraction_;
  double least_length_, most_length_;
  Shape shape_;
  std::vector<Target> targets_;  // The last one is the tip.
  bool sliding_ = false;         // Whether matches follow the shape.
  double variance_ = 0;          // Of the residuals, that the penalty is measured by.
  double largest_distance_ = 0, rms_distance_ = 0;
  int iterations_ = 0;
};

}  // namespace mane::rod
