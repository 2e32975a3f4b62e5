#include "beam/hull.h"

#include <fmt/format.h>

#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <limits>

namespace mane::beam {
namespace {

using Eigen::Vector3d;

// Columns of the fit that differ by less are one: float coordinates in a plane.
constexpr double kRank = 1e-5;
// Growth to enclose all points beyond which no ellipsoid comes near them.
constexpr double kLargestGrowth = 2;
constexpr double kGrowthMargin = 1e-9;

Error Unfit(const std::string& why) { return InvalidArgument({}, "the points " + why); }

}  // namespace

Vector3d DirectionOf(double zenith, double azimuth) {
  const double across = std::sin(zenith);
  return {across * std::sin(azimuth), std::cos(zenith), across * std::cos(azimuth)};
}

double Hull::At(const Vector3d& point) const {
  return (point - center).cwiseQuotient(radii).squaredNorm() - 1;
}

Vector3d Hull::Gradient(const Vector3d& point) const {
  return 2 * (point - center).cwiseQuotient(radii.cwiseAbs2());
}

Vector3d Hull::Point(double zenith, double azimuth) const {
  return center + radii.cwiseProduct(DirectionOf(zenith, azimuth));
}

Polar PolarOf(const Hull& hull, const Vector3d& point) {
  const Vector3d u = (point - hull.center).cwiseQuotient(hull.radii);
  const double across = std::hypot(u.x(), u.z());
  return {std::atan2(across, u.y()), across > 0 ? std::atan2(u.x(), u.z()) : 0};
}

// A coordinate where the hull is the unit ball is a sum of three products and an offset that come
// to (2 |c| + r) / r_min at most. It rounds by 2.5 epsilon of that, and by what its node does by
// half a float's; E rounds by sqrt(12) times as much and 1.5 epsilon, and radii that grow by a
// share lift it by twice that.
Hull Lifted(const Hull& hull, double epsilon) {
  const double rounding = 5.5 * epsilon + std::numeric_limits<float>::epsilon();
  const double largest = 2 * hull.center.norm() + hull.radii.maxCoeff();
  return {hull.center, hull.radii * (1 + rounding * largest / hull.radii.minCoeff())};
}

Result<Hull> FitHull(std::span<const Eigen::Vector3f> points) {
  const auto count = static_cast<Eigen::Index>(points.size());
  if (count < 6) return Unfit(fmt::format("are {}; an ellipsoid takes 6", count));
  Vector3d middle = Vector3d::Zero(), size = Vector3d::Zero();
  for (const auto& point : points) middle += point.cast<double>() / static_cast<double>(count);
  for (const auto& point : points) {
    size = size.cwiseMax((point.cast<double>() - middle).cwiseAbs());
  }
  if (!middle.allFinite() || !size.allFinite()) return Unfit("are not all finite");
  if (size.minCoeff() <= kRank * size.maxCoeff()) return Unfit("lie in a plane");

  // A x^2 + B y^2 + C z^2 + D x + E y + F z = 1 about the middle, in units of the size.
  Eigen::MatrixXd terms(count, 6);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vector3d x = (points[i].cast<double>() - middle).cwiseQuotient(size);
    terms.row(i) << x.cwiseAbs2().transpose(), x.transpose();
  }
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(terms);
  qr.setThreshold(kRank);
  if (qr.rank() < 6) return Unfit("lie in a plane or on more than one quadric");
  const Eigen::Matrix<double, 6, 1> fit = qr.solve(Eigen::VectorXd::Ones(count));
  const Vector3d square = fit.head<3>(), linear = fit.tail<3>();
  if (!(square.minCoeff() > 0)) return Unfit("lie on something that no ellipsoid comes near");
  const Vector3d center = -0.5 * linear.cwiseQuotient(square);
  const double level = 1 + square.dot(center.cwiseAbs2());
  Hull hull{middle + size.cwiseProduct(center),
            size.cwiseProduct((level * square.cwiseInverse()).cwiseSqrt())};

  double farthest = 0;
  for (const auto& point : points) farthest = std::max(farthest, hull.At(point.cast<double>()) + 1);
  const double growth = std::sqrt(farthest);
  if (!(growth < kLargestGrowth)) return Unfit("lie on something that no ellipsoid comes near");
  hull.radii *= growth * (1 + kGrowthMargin);
  return hull;
}

}  // namespace mane::beam
