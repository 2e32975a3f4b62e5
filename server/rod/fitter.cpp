#include "rod/fitter.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

#include "math/rigid.h"
#include "rod/fit_guess.h"

namespace mane::rod {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

constexpr double kFillWeight = 1e-2;  // Of a spline point in a gap between the polyline's.
constexpr double kFirstDoubt = 3e-3;  // Standard deviation that the penalty starts from.
constexpr int kRounds = 8;
// Guesses are tried from the first on, until one ends as near as this to the points.
constexpr std::array<double, 4> kTwistWeights = {1e-4, 1e-6, 1e-2, 1};
constexpr double kNear = 1e-3;
constexpr int kFirstBursts = 6, kBursts = 25, kPatience = 4;  // See Minimise.
constexpr double kLeastDamping = 1e-14, kMostDamping = 1e6;

}  // namespace

Fitter::Fitter(const SmoothCurve& curve, std::span<const Vector3d> points,
               std::vector<double> fraction, const std::optional<Matrix3d>& root)
    : curve_(curve),
      points_(points),
      root_(root ? *root : FrameAlong(curve.Tangent(0))),
      root_free_(!root),
      noise_(curve.noise()),
      cost_(std::move(fraction)) {
  const double L = curve.length();
  // A spline knows its length about as well as it differs from the polyline's.
  const double doubt =
      std::clamp(0.5 * (L - curve.chord_length()) / L + 5 * curve.noise() / L, 2e-3, 3e-2);
  least_length_ = L * (1 - doubt);
  most_length_ = L * (1 + doubt);
}

void Fitter::Start(double twist_weight) {
  shape_ = {root_, curve_.length(), GuessAngles(curve_, root_, cost_.fraction(), twist_weight)};
  cost_.sliding = false;
  SetTargets();
  Measure();
}

// The points themselves, and points of the spline where they would leave an element without.
void Fitter::SetTargets() {
  const double L = curve_.length();
  double widest = 1;
  for (int Q = 0; Q < cost_.N(); ++Q) widest = std::min(widest, 0.5 * cost_.Part(Q));
  targets_.clear();
  for (size_t i = 1; i < points_.size(); ++i) {
    const double begin = curve_.arc()[i - 1] / L, end = curve_.arc()[i] / L;
    const int pieces = static_cast<int>(std::min(std::ceil((end - begin) / widest), 1e3));
    for (int k = 1; k < pieces; ++k) {
      const double u = begin + (end - begin) * k / pieces;
      targets_.push_back({curve_.At(u * L), u, kFillWeight});
    }
    targets_.push_back({points_[i], end, 1});
  }
  targets_.back().u = 1;
}

FitCost::Shape Fitter::Moved(const VectorXd& step) const {
  Shape moved = shape_;
  moved.R = shape_.R * math::FromRotationVector({0, step[0], step[1]}).toRotationMatrix();
  moved.L =
      std::clamp(shape_.L * std::exp(std::clamp(step[2], -0.1, 0.1)), least_length_, most_length_);
  for (int Q = 0; Q < cost_.N(); ++Q) moved.theta[Q] += step.segment<3>(3 + 3 * Q);
  return moved;
}

// One step of Gauss and Newton, damped by `lambda` per rad^2.
VectorXd Fitter::Step(const std::vector<FitCost::Placed>& placed, double lambda) const {
  MatrixXd H;
  VectorXd g;
  cost_.Normal(shape_, targets_, placed, &H, &g);
  const double wall = 1e12 * H.diagonal().maxCoeff();
  H.diagonal().array() += lambda;
  // An unknown that is not free, or that its bound stops, stands still.
  const bool at_bound =
      (shape_.L <= least_length_ && g[2] > 0) || (shape_.L >= most_length_ && g[2] < 0);
  if (!root_free_) H.diagonal().head<2>().array() += wall;
  if (!cost_.sliding || at_bound) H(2, 2) += wall;
  const Eigen::LLT<MatrixXd, Eigen::Lower> factor(H);
  if (factor.info() != Eigen::Success) return VectorXd();
  VectorXd step = -factor.solve(g);
  return step.allFinite() && step.cwiseAbs().maxCoeff() < 10 ? step : VectorXd();
}

// Levenberg and Marquardt at a fixed penalty, with patience: a change of angles that leaves the tip
// where it is runs along a narrow curved valley, which a step leaves uphill and the next ones
// return to. A burst of steps is taken back unless one of them ends below where it began.
void Fitter::Minimise() {
  std::vector<FitCost::Placed> placed = cost_.Place(shape_, &targets_);
  double cost = cost_.Value(shape_, targets_, placed);
  double lambda = 1e-4;
  for (int burst = 0; burst < (cost_.sliding ? kBursts : kFirstBursts) && lambda < kMostDamping;
       ++burst) {
    const Shape shape = shape_;
    const std::vector<FitCost::Target> targets = targets_;
    std::vector<FitCost::Placed> trial = placed;
    double trial_cost = cost;
    for (int k = 0; k < kPatience && !(trial_cost < cost); ++k, ++iterations_) {
      const VectorXd step = Step(trial, lambda);
      if (step.size() == 0) break;
      shape_ = Moved(step);
      trial = cost_.Place(shape_, &targets_);
      trial_cost = cost_.Value(shape_, targets_, trial);
    }
    if (!(trial_cost < cost)) {
      shape_ = shape;
      targets_ = targets;
      lambda *= 10;
      continue;
    }
    const bool settled = trial_cost > (1 - 1e-4) * cost;
    placed.swap(trial);
    cost = trial_cost;
    lambda = std::max(0.1 * lambda, kLeastDamping);
    if (settled) break;
  }
}

// Distances of the polyline's own points.
void Fitter::Measure() {
  const std::vector<FitCost::Placed> placed = cost_.Place(shape_, &targets_);
  double sum = 0;
  int count = 0;
  largest_distance_ = 0;
  for (size_t i = 0; i < targets_.size(); ++i) {
    if (targets_[i].weight < 1) continue;
    const double distance = (placed[i].r - targets_[i].x).norm();
    largest_distance_ = std::max(largest_distance_, distance);
    sum += distance * distance;
    ++count;
  }
  rms_distance_ = std::sqrt(sum / count);
}

// First with the spline's matches and length, then with the nearest ones.
void Fitter::RunFromHere() {
  for (int round = 0; round < kRounds; ++round) {
    const double before = rms_distance_;
    const double doubt = kFirstDoubt * std::pow(0.1, round);
    cost_.variance = std::max({noise_ * noise_, doubt * doubt, 1e-4 * before * before, 1e-22});
    Minimise();
    if (!cost_.sliding) {
      cost_.sliding = true;
      Measure();
      continue;
    }
    Measure();
    if (rms_distance_ < 1e-11 || (rms_distance_ > 0.99 * before && doubt < rms_distance_)) break;
  }
}

void Fitter::Run() {
  Start(kTwistWeights[0]);
  RunFromHere();
  for (size_t i = 1; i < kTwistWeights.size() && rms_distance_ > kNear; ++i) {
    const Shape best = shape_;
    const double largest = largest_distance_, rms = rms_distance_;
    Start(kTwistWeights[i]);
    RunFromHere();
    if (rms_distance_ <= rms) continue;
    shape_ = best;
    largest_distance_ = largest;
    rms_distance_ = rms;
  }
}

}  // namespace mane::rod
