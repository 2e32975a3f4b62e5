#include "rod/fitter.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

#include "math/rigid.h"
#include "math/stumpff.h"
#include "rod/fit_guess.h"
#include "rod/helix.h"

namespace mane::rod {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Matrix7 = Eigen::Matrix<double, 7, 7>;
using Matrix73 = Eigen::Matrix<double, 7, 3>;
using Vector7 = Eigen::Matrix<double, 7, 1>;

namespace {

constexpr double kSlide = 1e-2;       // Weight of residuals along the tangent.
constexpr double kFillWeight = 1e-2;  // Of a spline point in a gap between the polyline's.
constexpr double kTwistScale = 0.5;   // rad: typical twist of an element,
constexpr double kJumpScale = 1.0;    // rad: and jump of its angles from the last one's (F5).
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
      fraction_(std::move(fraction)) {
  const double L = curve.length();
  // A spline knows its length about as well as it differs from the polyline's.
  const double doubt =
      std::clamp(0.5 * (L - curve.chord_length()) / L + 5 * curve.noise() / L, 2e-3, 3e-2);
  least_length_ = L * (1 - doubt);
  most_length_ = L * (1 + doubt);
}

void Fitter::Start(double twist_weight) {
  shape_ = {root_, curve_.length(), GuessAngles(curve_, root_, fraction_, twist_weight)};
  sliding_ = false;
  SetTargets();
  Measure();
}

// The points themselves, and points of the spline where they would leave an element without.
void Fitter::SetTargets() {
  const double L = curve_.length();
  double widest = 1;
  for (int Q = 0; Q < N(); ++Q) widest = std::min(widest, 0.5 * Part(Q));
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

// Matches of the targets at `shape`; where they slide, moved to the nearest point nearby, in order.
std::vector<Fitter::Placed> Fitter::Place(const Shape& shape, std::vector<Target>* targets) const {
  std::vector<Matrix3d> R(N() + 1);
  std::vector<Vector3d> r(N() + 1);
  R[0] = shape.R;
  r[0].setZero();
  for (int Q = 0; Q < N(); ++Q) {
    const ElementEnd end = EndOfElement(shape.theta[Q]);
    r[Q + 1] = r[Q] + shape.L * Part(Q) * (R[Q] * end.p);
    R[Q + 1] = R[Q] * end.E;
  }
  const auto at = [&](double u) {
    const auto after = std::upper_bound(fraction_.begin() + 1, fraction_.end() - 1, u);
    const int Q = static_cast<int>(after - fraction_.begin()) - 1;
    const Vector3d& th = shape.theta[Q];
    const double s = (u - fraction_[Q]) / Part(Q);
    const math::Stumpff C = math::StumpffC(s * s * th.squaredNorm());
    const Vector3d A(0, th.z(), -th.y()), B = th.cross(A), d0 = Vector3d::UnitX();
    return Placed{Q, s,
                  r[Q] + shape.L * Part(Q) * s * (R[Q] * (d0 + s * C[2] * A + s * s * C[3] * B)),
                  R[Q] * (d0 + s * C[1] * A + s * s * C[2] * B)};
  };
  std::vector<Placed> placed(targets->size());
  double last = 0;
  for (size_t i = 0; i < targets->size(); ++i) {
    Target& target = (*targets)[i];
    placed[i] = at(target.u);
    if (!sliding_ || i + 1 == targets->size()) continue;
    const double reach = 0.5 / N();
    for (int pass = 0; pass < 3; ++pass) {
      const double along = placed[i].t.dot(target.x - placed[i].r) / shape.L;
      target.u = std::clamp(target.u + std::clamp(along, -reach, reach), last, 1.0);
      placed[i] = at(target.u);
    }
    last = target.u;
  }
  return placed;
}

double Fitter::Cost(const Shape& shape, const std::vector<Target>& targets,
                    const std::vector<Placed>& placed) const {
  double cost = 0;
  for (size_t i = 0; i < targets.size(); ++i) {
    cost += targets[i].weight * (placed[i].r - targets[i].x).squaredNorm();
  }
  double penalty = 0;
  for (int Q = 0; Q < N(); ++Q) {
    penalty += std::pow(shape.theta[Q].x() / kTwistScale, 2);
    if (Q == 0) continue;
    const double mean = 0.5 * (Part(Q) + Part(Q - 1)) / kJumpScale;
    penalty += (mean * (shape.theta[Q] / Part(Q) - shape.theta[Q - 1] / Part(Q - 1))).squaredNorm();
  }
  return cost + variance_ * penalty;
}

// Gauss and Newton's matrix and slope over (root 2, length 1, angles 3N). All beyond an element
// moves with it as a rigid body, and with the length as a similar one: a twist of seven numbers, so
// that the sums over points beyond are one 7 x 7 matrix (F6).
void Fitter::Normal(const std::vector<Placed>& placed, MatrixXd* H, VectorXd* g) const {
  const int n = N();
  H->setZero(3 + 3 * n, 3 + 3 * n);
  g->setZero(3 + 3 * n);
  std::vector<Matrix73> S(n);  // Twist of all beyond, per rate.
  std::vector<Matrix3d> frame(n);
  Matrix3d R = shape_.R;
  Vector3d r = Vector3d::Zero();
  for (int Q = 0; Q < n; ++Q) {
    const ElementEnd end = EndOfElement(shape_.theta[Q]);
    const double l = shape_.L * Part(Q);
    frame[Q] = R;
    r += l * (R * end.p);
    const Matrix3d turn = R * end.T;
    S[Q] << l * R * end.J + math::Cross(r) * turn, turn, Eigen::RowVector3d::Zero();
    R = R * end.E;
  }
  Matrix7 M = Matrix7::Zero();
  Vector7 b = Vector7::Zero();
  size_t i = placed.size();
  for (int Q = n - 1; Q >= 0; --Q) {
    Matrix73 F = M * S[Q];
    Matrix3d own = S[Q].transpose() * F;
    Vector3d slope = S[Q].transpose() * b;
    for (; i > 0 && placed[i - 1].element == Q; --i) {
      const Placed& point = placed[i - 1];
      const Target& target = targets_[i - 1];
      Matrix3d W = target.weight * Matrix3d::Identity();
      if (sliding_ && i < placed.size()) {
        W -= target.weight * (1 - kSlide) * point.t * point.t.transpose();
      }
      Eigen::Matrix<double, 3, 7> C;
      C << Matrix3d::Identity(), -math::Cross(point.r), point.r;
      const Matrix3d J = shape_.L * Part(Q) * frame[Q] * PointOnElement(shape_.theta[Q], point.s).J;
      const Vector3d e = W * (point.r - target.x);
      const Eigen::Matrix<double, 3, 7> WC = W * C;
      own += J.transpose() * W * J;
      slope += J.transpose() * e;
      F += WC.transpose() * J;
      M += C.transpose() * WC;
      b += C.transpose() * e;
    }
    H->block<3, 3>(3 + 3 * Q, 3 + 3 * Q) = own;
    g->segment<3>(3 + 3 * Q) = slope;
    for (int P = 0; P < Q; ++P) {
      H->block<3, 3>(3 + 3 * Q, 3 + 3 * P) = F.transpose() * S[P];
    }
    H->block<3, 2>(3 + 3 * Q, 0) = F.middleRows<3>(3).transpose() * shape_.R.rightCols<2>();
    H->block<3, 1>(3 + 3 * Q, 2) = F.row(6).transpose();
  }
  const Eigen::Matrix<double, 3, 2> turns = shape_.R.rightCols<2>();
  H->topLeftCorner<2, 2>() = turns.transpose() * M.block<3, 3>(3, 3) * turns;
  H->block<1, 2>(2, 0) = M.block<1, 3>(6, 3) * turns;
  (*H)(2, 2) = M(6, 6);
  g->head<2>() = turns.transpose() * b.segment<3>(3);
  (*g)[2] = b[6];
}

void Fitter::AddPenalty(MatrixXd* H, VectorXd* g) const {
  for (int Q = 0; Q < N(); ++Q) {
    const double twist = variance_ / (kTwistScale * kTwistScale);
    (*H)(3 + 3 * Q, 3 + 3 * Q) += twist;
    (*g)[3 + 3 * Q] += twist * shape_.theta[Q].x();
    if (Q == 0) continue;
    const double a = 1 / Part(Q - 1), c = 1 / Part(Q);
    const double jump = variance_ * std::pow(0.5 * (Part(Q) + Part(Q - 1)) / kJumpScale, 2);
    const Vector3d d = c * shape_.theta[Q] - a * shape_.theta[Q - 1];
    g->segment<3>(3 * Q) -= jump * a * d;
    g->segment<3>(3 + 3 * Q) += jump * c * d;
    for (int k = 0; k < 3; ++k) {
      (*H)(3 * Q + k, 3 * Q + k) += jump * a * a;
      (*H)(3 + 3 * Q + k, 3 + 3 * Q + k) += jump * c * c;
      (*H)(3 + 3 * Q + k, 3 * Q + k) -= jump * a * c;
    }
  }
}

Fitter::Shape Fitter::Moved(const VectorXd& step) const {
  Shape moved = shape_;
  moved.R = shape_.R * math::FromRotationVector({0, step[0], step[1]}).toRotationMatrix();
  moved.L =
      std::clamp(shape_.L * std::exp(std::clamp(step[2], -0.1, 0.1)), least_length_, most_length_);
  for (int Q = 0; Q < N(); ++Q) moved.theta[Q] += step.segment<3>(3 + 3 * Q);
  return moved;
}

// One step of Gauss and Newton, damped by `lambda` per rad^2.
VectorXd Fitter::Step(const std::vector<Placed>& placed, double lambda) const {
  MatrixXd H;
  VectorXd g;
  Normal(placed, &H, &g);
  AddPenalty(&H, &g);
  const double wall = 1e12 * H.diagonal().maxCoeff();
  H.diagonal().array() += lambda;
  // An unknown that is not free, or that its bound stops, stands still.
  const bool at_bound =
      (shape_.L <= least_length_ && g[2] > 0) || (shape_.L >= most_length_ && g[2] < 0);
  if (!root_free_) H.diagonal().head<2>().array() += wall;
  if (!sliding_ || at_bound) H(2, 2) += wall;
  const Eigen::LLT<MatrixXd, Eigen::Lower> factor(H);
  if (factor.info() != Eigen::Success) return VectorXd();
  VectorXd step = -factor.solve(g);
  return step.allFinite() && step.cwiseAbs().maxCoeff() < 10 ? step : VectorXd();
}

// Levenberg and Marquardt at a fixed penalty, with patience: a change of angles that leaves the tip
// where it is runs along a narrow curved valley, which a step leaves uphill and the next ones
// return to. A burst of steps is taken back unless one of them ends below where it began.
void Fitter::Minimise() {
  std::vector<Placed> placed = Place(shape_, &targets_);
  double cost = Cost(shape_, targets_, placed);
  double lambda = 1e-4;
  for (int burst = 0; burst < (sliding_ ? kBursts : kFirstBursts) && lambda < kMostDamping;
       ++burst) {
    const Shape shape = shape_;
    const std::vector<Target> targets = targets_;
    std::vector<Placed> trial = placed;
    double trial_cost = cost;
    for (int k = 0; k < kPatience && !(trial_cost < cost); ++k, ++iterations_) {
      const VectorXd step = Step(trial, lambda);
      if (step.size() == 0) break;
      shape_ = Moved(step);
      trial = Place(shape_, &targets_);
      trial_cost = Cost(shape_, targets_, trial);
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
  const std::vector<Placed> placed = Place(shape_, &targets_);
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
    variance_ = std::max({noise_ * noise_, doubt * doubt, 1e-4 * before * before, 1e-22});
    Minimise();
    if (!sliding_) {
      sliding_ = true;
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
